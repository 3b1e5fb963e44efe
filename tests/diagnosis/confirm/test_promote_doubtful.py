"""An experiment that joins those to choose with where these have too few windows to be sure of a law that removes most of the error."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import promote_doubtful as module
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.promote_doubtful import promote_doubtful
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown

from .conftest import FAST, SLOW

SETTINGS = DiagnosisSettings()


@pytest.fixture
def asked(stub, monkeypatch, drag_at_speed):
    """The experiment that is taken for one law of a first step, and what is said of it; None where none is."""

    def ask(
        *, significance: float = 2.7, removed: float = 0.6, share: float = 0.7, away: float = 20.0, **how: Any
    ) -> Any:
        plain, fitted = stub(name="plain"), stub(name="fitted")
        law = how.get("law", Attachment("rotor", QuadraticDrag()))
        ranked = stub(
            candidate=stub(attachment=law),
            fitted=fitted,
            significance=significance,
            removed=removed,
            gain=1.0,
            unknown=law.mechanism.free,
        )
        steps = [stub(parent=stub(effects=how.get("beside", ())), ranked=[ranked])]
        effects = how.get("effects", ())
        state = stub(effects=effects, has_curve=any(e.mechanism.free for e in effects), steps=steps, plain=plain)
        errors = {"plain": np.array([3.0, 3.0]), "fitted": np.array([2.0, 1.0])}
        others = stub(fits=lambda of: of, times_noise=lambda of: errors[of.name])
        monkeypatch.setattr(module, "gain", lambda before, after: Gain(share, share / away))
        monkeypatch.setattr(module, "sound", lambda study, r: how.get("sound", True))
        monkeypatch.setattr(module, "over_the_same_windows", lambda one, other: True)
        data = drag_at_speed((SLOW, *[FAST] * how.get("validation", 2)))
        found = promote_doubtful(stub(settings=SETTINGS), data, state, others)
        return None if found is None else (found.taken, found.why, [r.name for r in data.validation()])

    return ask


def test_the_experiment_that_the_law_predicts_best_is_taken(asked) -> None:
    taken, why, validation = asked()
    assert taken == validation[1]
    assert why.startswith("quadratic drag at rotor removes 70 % of the squared error of held-out windows")


def test_a_curve_alone_is_no_name(asked) -> None:
    assert asked(effects=(Attachment("rotor", Unknown("speed")),)) is not None


@pytest.mark.parametrize(
    "why_not",
    [
        {"significance": 3.5},  # sure: it would have been taken, had nothing else spoken against it
        {"significance": 1.5},  # chance
        {"removed": 0.4},
        {"share": 0.4},  # held-out windows do not bear it out
        {"away": 2.0},
        {"sound": False},
        {"validation": 1},  # none would be left to judge
        {"law": Attachment("rotor", Unknown("speed"))},
        {"beside": (Attachment("rotor", QuadraticDrag()),)},
        {"effects": (Attachment("rotor", QuadraticDrag()),)},
    ],
)
def test_none_is_taken_elsewhere(asked, why_not: dict[str, Any]) -> None:
    assert asked(**why_not) is None
