"""Values by name, which say what names there are."""

from __future__ import annotations

from typing import TypeVar

from greybox_torch.errors import did_you_mean

Entry = TypeVar("Entry")


class ByName(dict[str, Entry]):
    """Parameters by name; asked for another, it says which names there are."""

    def __missing__(self, name: object) -> Entry:
        raise KeyError(f"no parameter {name!r}{did_you_mean(str(name), self)}; there are: {', '.join(self)}")
