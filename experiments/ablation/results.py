"""What was measured of a case, kept on disk after every model so that an interrupted run goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from greybox_torch import UserError
from greybox_torch.files import json_text, write_text

SCHEMA = "greybox-ablation/1"


@dataclass(frozen=True)
class Entry:
    """One model, trained once.

    ``estimation`` and ``validation`` are fits in % of free runs, means over experiments and outputs; ``drift`` the relative change of every
    physical parameter against the re-estimated physics; ``seconds`` of the clock and ``processor_seconds`` of all threads; ``detail`` what
    else is worth keeping.
    """

    model: str
    seed: int | None
    estimation: float
    validation: float
    seconds: float
    processor_seconds: float
    drift: Mapping[str, float] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)


@dataclass
class Case:
    """A data set and what was measured on it; ``about`` holds what all entries depend on: data, network, versions, machine."""

    name: str
    about: dict[str, Any]
    entries: list[Entry] = field(default_factory=list)
    notes: dict[str, Any] = field(default_factory=dict)

    def find(self, model: str, seed: int | None = None) -> Entry | None:
        return next((e for e in self.entries if (e.model, e.seed) == (model, seed)), None)

    def of(self, model: str) -> list[Entry]:
        """All entries of a model, by seed."""
        return sorted((e for e in self.entries if e.model == model), key=lambda e: e.seed or 0)

    def save(self, folder: Path) -> None:
        content = {"schema": SCHEMA, **asdict(self)}
        write_text(folder / "results.json", json_text(content))


def load_case(folder: Path, name: str, about: dict[str, Any], same: tuple[str, ...]) -> Case:
    """The case kept in ``folder``, or a new one where there is none.

    Raises:
        UserError: what is kept differs from ``about`` in one of ``same``: it is of other data or settings.
    """
    path = folder / "results.json"
    if not path.is_file():
        return Case(name, about)
    kept = read_case(path)
    for key in same:
        if kept.about.get(key) != about[key]:
            raise UserError(
                f"{path}: its {key} is {json.dumps(kept.about.get(key))}, and now it is {json.dumps(about[key])}; "
                "expected results of the same data and settings: choose another --out, or remove them"
            )
    return kept


def read_case(path: Path) -> Case:
    """The case in a results.json. Raises UserError where that is damaged or of another schema."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["schema"] != SCHEMA:
            raise UserError(f'{path}: schema is {json.dumps(content["schema"])}, expected "{SCHEMA}"')
        entries = [_entry(entry) for entry in content["entries"]]
        return Case(content["name"], content["about"], entries, content["notes"])
    except (json.JSONDecodeError, KeyError, TypeError) as error:
        raise UserError(f"{path}: damaged ({type(error).__name__}: {error}); remove it to measure anew") from None


def _entry(kept: dict[str, Any]) -> Entry:
    """An entry from JSON, where null stands for what is not finite: the fit of a run that overflowed, a time that is not known."""
    fits = {role: float("-inf") if kept[role] is None else kept[role] for role in ("estimation", "validation")}
    times = {name: float("nan") if kept[name] is None else kept[name] for name in ("seconds", "processor_seconds")}
    return Entry(**{**kept, **fits, **times})
