"""A diagnosis asks about channels beside findings that explain much only where these may make up for a slip on the card."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.api.short_refits import Asked
from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.own_parameters import Estimate
from greybox_torch.diagnosis.pipeline import Diagnosis
from greybox_torch.diagnosis.verdict import Left, Verdict
from greybox_torch.estimate.comparison import Score

module = import_module("greybox_torch.api.diagnose")
MODEL: Any = SimpleNamespace(all_ports=())
DRY = Effect("belt", "coulomb", 0.97, ("speed",), "", {}, 0.5, (), None, size=0.85)
MASS = Estimate("m", "kg", 8.0, (9.0, 0.1), (0.1, 0.1), (False, True))
BEFORE_ALONE, ZERO = replace(MASS, at_bound=(True, False)), replace(MASS, augmented=(0.0, 0.1))


def asked(monkeypatch: pytest.MonkeyPatch, reaches: float, fit: float, mass: Estimate, times: float) -> tuple[int, str]:
    """How often it was asked, and the question that is told."""
    calls: list[float] = []
    monkeypatch.setattr(
        module, "asked_where_poor", lambda *given: calls.append(1) or Asked("Turned?", reaches, "Turned?")
    )
    scores = {n: (Score("C", "validation", "y", f, 1.0),) for n, f in (("refit", 20.0), ("augmented", fit))}
    scores["start"] = scores["refit"]
    verdict = Verdict("axis", "Axis", 0, 1.0, 0.97, (DRY,), scores, (), {}, ())
    verdict = replace(verdict, parameters=(mass,), left=Left(0.1, times, ""))
    found = Diagnosis(verdict, None, {}, {}, [])  # pyright: ignore
    told = module._with_question(found, None, MODEL, "cpu", print, Deadline.after(None)).verdict
    return len(calls), told.question or ""


@pytest.mark.parametrize(
    ("reaches", "fit", "mass", "times", "expected"),
    [
        (99.5, 98.3, MASS, 5.0, (1, "Turned?")),  # rpm read as rad/s
        (99.0, 98.3, MASS, 5.0, (1, "")),  # no far better answer
        (99.5, 98.3, BEFORE_ALONE, 5.0, (0, "")),
        (99.5, 98.3, ZERO, 5.0, (0, "")),
        (99.5, 98.3, MASS, 1.1, (0, "")),  # hardly more than noise is left
        (80.0, 60.0, BEFORE_ALONE, 5.0, (1, "Turned?")),  # a poor answer
    ],
)
def test_a_good_answer_is_asked_about_only_where_it_may_make_up_for_a_slip(
    reaches: float, fit: float, mass: Estimate, times: float, expected: tuple[int, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert asked(monkeypatch, reaches, fit, mass, times) == expected
