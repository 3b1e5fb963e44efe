"""The regression's library: terms that exist, are finite, and speak for mechanisms that exist."""

from __future__ import annotations

import pytest
import torch

from experiments.concealed.against.terms import Term, terms
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.model import Signals

SIGNALS = {
    "body": ("speed", "position", "load", "time"),
    "coupling": ("deflection", "rate", "position", "time"),
    "balance": ("level", "time"),
    "actuator": ("input", "speed", "time"),
}


def around(kind: str, unit: str = "rad") -> Surroundings:
    ranges = {name: Range(0.0 if name == "time" else -2.0, 3.0, 1.0) for name in SIGNALS[kind]}
    return Surroundings(ranges, {"position": unit}, "N m", 0.001)


@pytest.mark.parametrize("kind", SIGNALS)
def test_terms_have_names_of_their_own_and_speak_for_mechanisms_of_the_library(kind: str) -> None:
    library = terms(kind, around(kind))
    assert len({t.name for t in library}) == len(library) > 3
    for term in library:
        for said in (term.positive, term.negative):
            assert said in ("", "unknown") or kind in LIBRARY[said].kinds, term.name


@pytest.mark.parametrize("kind", SIGNALS)
def test_terms_are_finite_and_differ(kind: str) -> None:
    generator = torch.Generator().manual_seed(0)
    values = {n: 5.0 * torch.rand(200, dtype=torch.float64, generator=generator) - 2.0 for n in SIGNALS[kind]}
    library = terms(kind, around(kind))
    table = torch.stack([torch.broadcast_to(t.value(Signals("signal", values)), (200,)) for t in library])
    assert torch.isfinite(table).all()
    assert torch.linalg.matrix_rank(table, atol=1e-9) == len(library)


def test_terms_whose_signals_are_not_there_are_left_out() -> None:
    bare = Surroundings({n: Range(0.0, 1.0, 1.0) for n in ("speed", "time")}, {}, "N m", 0.001)
    assert all(set(t.needs) <= {"speed", "time"} for t in terms("body", bare))


def test_a_position_in_metres_has_no_turns() -> None:
    assert not [t.name for t in terms("body", around("body", "m")) if "θ" in t.name]


def test_the_sign_tells_play_from_a_spring_that_is_stiff_at_first() -> None:
    term = next(t for t in terms("coupling", around("coupling")) if t.name.startswith("tanh(δ"))
    assert isinstance(term, Term)
    assert (term.speaks_for(1.0), term.speaks_for(-1.0)) == ("nonlinear_stiffness", "backlash")
