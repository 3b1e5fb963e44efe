"""Which experiment and channel of a card ask for a column or a file, in front of a message that there is none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from greybox_torch.data.expression import Expression
from greybox_torch.data.readers.table import NoSuchColumn
from greybox_torch.errors import UserError
from greybox_torch.files import toml_key


def left_out(channel: str) -> str:
    """What can be done where one of several experiments lacks a channel."""
    return f'leave the experiment out of the card, or give the channel a column there: columns = {{ {toml_key(channel)} = "…" }}'


@contextmanager
def asked_for(place: str, channels: Mapping[str, Expression], clock: str | None, *, alone: bool) -> Iterator[None]:
    """What the readers refuse within the block is told with the place on the card that asks for it.

    Args:
        place: the card and the experiment.
        channels: by name, what each is made of.
        clock: the column of time stamps, if there is one.
        alone: whether it is the only experiment, so that it cannot be left out.
    """
    try:
        yield
    except NoSuchColumn as error:
        wanting = [name for name, formula in channels.items() if error.column in formula.columns]
        advice = f"; where only this experiment lacks it, {left_out(wanting[0])}" if wanting and not alone else ""
        where = "".join(f', channel "{name}"' for name in wanting) or (", time" if error.column == clock else "")
        raise NoSuchColumn(f"{place}{where}: {error}{advice}", error.column) from None
    except UserError as error:
        raise UserError(f"{place}: {error}") from None
