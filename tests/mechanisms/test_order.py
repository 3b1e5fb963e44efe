"""The pieces of a law stand in the same order in every family."""

from __future__ import annotations

import pytest

from greybox_torch.mechanisms.library import LEARNED, LIBRARY
from greybox_torch.mechanisms.linear_law import LinearLaw
from greybox_torch.mechanisms.mechanism import Mechanism

DECLARED = [
    "name",
    "kinds",
    "needs",
    "kinematic",
    "fades",
    "generalises",
    "includes",
    "twins",
    "essential",
    "natural",
    "explanation",
    "source",
    "experiment",
    "parameter",
    "measured_in",
    "lower",
    "upper",
    "description",
]
METHODS = [
    "__init__",
    "parameters",
    "states",
    "starts",
    "rates",
    "law",
    "force",
    "deflection",
    "reaction",
    "force_beside",
    "probes",
    "misplaced",
    "degenerate",
    "options",
    "signals",
]
LAWS = [pytest.param(law, id=law.name) for law in (*LIBRARY.values(), *LEARNED.values())]


@pytest.mark.parametrize("law", LAWS)
def test_pieces_stand_in_order(law: type[Mechanism]) -> None:
    for order in (DECLARED, METHODS):
        pieces = [name for name in vars(law) if name in order]
        assert pieces == sorted(pieces, key=order.index)


@pytest.mark.parametrize("law", LAWS)
def test_attributes_stand_before_methods_and_helpers_behind(law: type[Mechanism]) -> None:
    known = [name for name in vars(law) if name in (*DECLARED, *METHODS)]
    assert known == sorted(known, key=lambda name: name in METHODS)
    own = [name for name in vars(law) if not name.startswith("__") or name == "__init__"]
    private = [name.startswith("_") and name != "__init__" for name in own]
    assert private == sorted(private)


def test_what_one_parameter_says_is_declared() -> None:
    linear = [law for law in LIBRARY.values() if issubclass(law, LinearLaw)]
    assert len(linear) >= 10
    for law in linear:
        assert "parameters" not in vars(law), "declared by class attributes, not written again"
