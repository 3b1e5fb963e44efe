"""Hypotheses of which no recording can tell which is right, as they are one effect in the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from greybox_torch.api.expected import NOTHING
from greybox_torch.diagnosis.one_of import DECIDED_BY
from greybox_torch.mechanisms.one_effect import one_effect
from greybox_torch.name_lists import listed

if TYPE_CHECKING:
    from greybox_torch.api.hypotheses import Kept


def same_as_first(group: Sequence[Kept]) -> list[Kept]:
    """The first of some hypotheses, and those that are one effect with it in the model."""
    first, *rivals = group
    own = first.model.values()
    return [first, *(r for r in rivals if one_effect(first.model, r.model, own, r.model.values()))]


def inseparable(group: Sequence[Kept]) -> list[Kept]:
    """Those of a group that are not next to nothing, where all of them are one effect; else none."""
    asked = [kept for kept in group if kept.probability >= NOTHING]
    return asked if len(asked) > 1 and len(same_as_first(asked)) == len(asked) else []


def told_one_effect(same: Sequence[Kept]) -> str:
    """That hypotheses are one effect, and what decides between them, in a sentence without a full stop."""
    return f"{listed([kept.name for kept in same])} are one effect in this model, whatever the input: {DECIDED_BY}"
