"""Which experiment and channel of a card ask for a column or a file, in front of a message that there is none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from greybox_torch.data.card_constants import as_constant
from greybox_torch.data.expression import Expression
from greybox_torch.data.readers.table import NoSuchColumn
from greybox_torch.errors import UserError
from greybox_torch.files import toml_key


def left_out(channel: str) -> str:
    """What can be done where one of several experiments lacks a channel."""
    return (
        f'leave the experiment out of the card, or give the channel a column there: columns = {{ {toml_key(channel)} = "…" }}, '
        f"or its value where it has one throughout: {as_constant(channel)}"
    )


@contextmanager
def asked_for(
    place: str,
    channels: Mapping[str, Expression],
    clocks: Sequence[str],
    others: Sequence[Path],
    read: Callable[..., object],
) -> Iterator[None]:
    """What the readers refuse within the block is told with the place on the card that asks for it.

    Args:
        place: the card and the experiment.
        channels: by name, what each is made of.
        clocks: the column of time stamps, if there is one, and that of their dates.
        others: files of the other experiments, by ``read`` of which it is known whether one has what this one lacks.
    """
    try:
        yield
    except NoSuchColumn as error:
        wanting = [name for name, formula in channels.items() if error.column in formula.columns]
        elsewhere = wanting and any(_has(read, file, error.column) for file in others)
        advice = f"; other experiments have it: {left_out(wanting[0])}" if elsewhere else ""
        where = "".join(f', channel "{name}"' for name in wanting) or (", time" if error.column in clocks else "")
        raise NoSuchColumn(f"{place}{where}: {error}{advice}", error.column) from None
    except UserError as error:
        raise UserError(f"{place}: {error}") from None


def _has(read: Callable[..., object], file: Path, column: str) -> bool:
    try:
        read(file, (column,))
    except UserError:
        return False
    return True
