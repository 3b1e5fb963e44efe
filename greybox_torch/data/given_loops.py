"""Loops of a controller that are given from Python."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from greybox_torch.data.card_controller import LoopEntry, check_loops
from greybox_torch.data.card_errors import entries
from greybox_torch.errors import UserError


def loops_of(
    given: Mapping[str, LoopEntry | Mapping[str, Any]] | None, channels: Collection[str], hold: str, of: str
) -> dict[str, LoopEntry]:
    """The loops by the input that they drive, read and checked as those of a card.

    Args:
        channels: names of the channels that there are.
        of: what the argument belongs to, for messages.

    Raises:
        UserError: naming the argument and the entry.
    """
    loops = entries("controller", given, LoopEntry, of)
    try:
        check_loops(loops, channels, hold)
    except ValueError as error:
        raise UserError(f"{of}: {error}") from None
    return loops
