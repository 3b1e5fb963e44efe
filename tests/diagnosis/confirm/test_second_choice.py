"""Named laws are asked of held-out experiments where those refute the curve that was preferred to them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import second_choice as module
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of


@pytest.fixture
def asked(stub, monkeypatch) -> Any:
    """What is left of a search that took a curve before an overflow, once held-out experiments have refuted the curve."""

    def ranked(name: str, gain: float, significance: float) -> Any:
        fitted, candidate = stub(effects=(name,), values=dict), stub(attachment=None)
        return stub(unknown=name == "curve", gain=gain, significance=significance, fitted=fitted, candidate=candidate)

    def make(
        held_out: Gain,
        *,
        gain: float = 0.3,
        times: float = 30.0,
        taken: bool = True,
        fine: bool = False,
        leak: float | None = None,
    ) -> SearchState:
        plain = stub(effects=())
        overflow, curve = ranked("overflow", gain, 3.0), ranked("curve", 0.9, 4.0)
        others = () if leak is None else (ranked("leak", leak, 2.0),)
        steps = (SelectionStep((), plain, (curve, *others, overflow), curve),) if taken else ()
        if fine:
            steps = (SelectionStep((), plain, (curve, overflow), None), SelectionStep((), plain, (curve,), curve))
        monkeypatch.setattr(
            module, "compare", lambda study, parent, screened, names: stub(parent=parent, ranked=tuple(names))
        )
        monkeypatch.setattr(module, "gain", lambda before, after: held_out)
        monkeypatch.setattr(module, "sound", lambda *given: True)
        monkeypatch.setattr(module, "least_gain", lambda fitted, settings: 0.05)
        monkeypatch.setattr(module, "times_noise", lambda *given: 30.0)
        monkeypatch.setattr(module, "mismatch_share", lambda *given: 1.0)
        monkeypatch.setattr(module, "drop_superfluous", lambda study, state: iter_of(state))
        held = stub(fits=lambda hypothesis: (), times_noise=lambda hypothesis: np.array([times, 40.0]))
        study = stub(settings=DiagnosisSettings(), surroundings={}, problem=None, working_on=lambda what: None)
        return result_of(module.second_choice(study, SearchState(plain, plain, steps), held))

    return make


def iter_of(state: SearchState) -> Any:
    """A stage that ends where it begins."""
    yield state
    return state


def test_the_law_beside_a_refuted_curve_is_taken_where_held_out_experiments_bear_it_out(asked) -> None:
    found = asked(Gain(0.2, 0.04, size=0.2))
    assert found.current.effects == ("overflow",)
    assert [step.taken.unknown for step in found.steps] == [True, False]


def test_the_names_that_stood_beside_coarse_curves_are_asked_where_a_fine_one_was_taken(asked) -> None:
    assert asked(Gain(0.2, 0.04, size=0.2), fine=True).current.effects == ("overflow",)


@pytest.mark.parametrize(("leak", "asked_for"), [(0.35, "overflow"), (0.5, "leak")])
def test_of_laws_that_gain_alike_the_one_that_most_windows_bear_out_is_asked(asked, leak, asked_for) -> None:
    """Seen: two tanks, whose lower one's overflow gains more in few windows, and whose upper one is the one that runs over."""
    assert asked(Gain(0.2, 0.04, size=0.2), leak=leak).current.effects == (asked_for,)


@pytest.mark.parametrize(
    "change",
    [
        pytest.param({"held_out": Gain(0.2, 0.1, size=0.2)}, id="within chance"),
        pytest.param({"gain": 0.04}, id="it hardly explains anything"),
        pytest.param({"times": 2.0}, id="near the noise on a held-out experiment"),
        pytest.param({"taken": False}, id="there was no curve"),
    ],
)
def test_else_nothing_is_left(asked, change: dict[str, Any]) -> None:
    found = asked(**{"held_out": Gain(0.2, 0.04, size=0.2), **change})
    assert found.current.effects == ()
