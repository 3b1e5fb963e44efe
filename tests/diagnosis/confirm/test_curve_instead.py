"""A free curve in the place of nothing, where free runs and held-out windows bear it out."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import curve_instead as module
from greybox_torch.diagnosis.confirm import far_better
from greybox_torch.diagnosis.confirm.curve_instead import curve_instead
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings

SURE, CHANCE = Gain(0.9, 0.1, size=0.9), Gain(0.9, 0.5, size=0.9)


def candidate(stub, prefix: str, gain: float, *, unknown: bool = True):
    effect = stub(prefix=prefix)
    return stub(
        candidate=stub(attachment=effect),
        fitted=stub(effects=(effect,), score=-gain, name=prefix),
        gain=gain,
        unknown=unknown,
    )


@pytest.mark.parametrize(
    ("left", "held_out", "noise", "stands"),
    [(0.2, SURE, 50.0, True), (0.6, SURE, 50.0, False), (0.2, CHANCE, 50.0, False), (0.2, SURE, 1.0, False)],
    ids=["borne out", "too much is left", "chance", "nothing is missing"],
)
def test_the_best_curve_of_the_first_step_stands_if_held_out_experiments_say_so(
    monkeypatch, stub, left, held_out, noise, stands
) -> None:
    """Seen: a dip and a bump of a rail, told as a ripple of six harmonics that did not last, and then as nothing with a name."""
    plain, rippled = stub(effects=()), stub(effects=("ripple",))
    ripple = candidate(stub, "cart.ripple", 2.9, unknown=False)
    curves = [candidate(stub, "cart.unknown", 2.4), candidate(stub, "actuator.unknown", 0.3)]
    steps = (
        stub(parent=plain, ranked=(ripple, *curves), taken=ripple, screened=()),
        stub(parent=rippled, ranked=(candidate(stub, "sensor.unknown", 9.0),), taken=None, screened=()),
    )
    by_it = stub(mismatch=lambda effects: left if effects else 1.0, holds=True, unstable=())
    monkeypatch.setattr(module, "as_fine_as_pays", lambda study, parent, ranked: ranked)
    monkeypatch.setattr(module, "sound", lambda study, ranked: True)
    monkeypatch.setattr(module, "in_order", lambda ranked, settings: sorted(ranked, key=lambda r: -r.gain))
    monkeypatch.setattr(module, "times_noise", lambda *args: noise)
    monkeypatch.setattr(far_better, "free_runs_of", lambda *asked: by_it)
    monkeypatch.setattr(far_better, "held_out_gains", lambda state, others: {"cart.unknown": held_out})
    study = stub(settings=DiagnosisSettings(), problem=None, working_on=lambda text: None)
    found = curve_instead(study, SearchState(plain, plain, steps), stub(), stub())
    assert (found is not None) is stands
    if found is not None:
        state, gains, judged = found
        assert state.current is curves[0].fitted and judged is by_it and gains == {"cart.unknown": SURE}
        assert state.steps[-1].taken is curves[0] and state.steps[-1].ranked == (curves[0],)


@pytest.mark.parametrize("kept", [True, False])
def test_the_curve_in_whose_place_names_stood_is_asked(monkeypatch, stub, kept) -> None:
    """Seen: a real servo's friction, told as a lag and a warm-up in the place of a curve; neither lasted: 63 times the noise, no name."""
    plain = stub(effects=())
    curve, lag = candidate(stub, "actuator.unknown", 4.0), candidate(stub, "sensor.lag", 3.9, unknown=False)
    by_curve = stub(parent=plain, ranked=(curve, lag), taken=curve, screened=())
    by_name = stub(parent=plain, ranked=(lag,), taken=lag, screened=())
    monkeypatch.setattr(module, "as_fine_as_pays", lambda study, parent, ranked: ranked)
    monkeypatch.setattr(module, "sound", lambda study, ranked: True)
    monkeypatch.setattr(module, "times_noise", lambda *args: 50.0)
    monkeypatch.setattr(module, "in_order", lambda ranked, settings: ranked)
    by_it = stub(mismatch=lambda effects: 0.1 if effects else 1.0, holds=True, unstable=())
    monkeypatch.setattr(far_better, "free_runs_of", lambda *asked: by_it)
    monkeypatch.setattr(far_better, "held_out_gains", lambda state, others: {"actuator.unknown": SURE})
    study = stub(settings=DiagnosisSettings(), problem=None, working_on=lambda text: None)
    state = SearchState(plain, plain, (by_name,), in_place_of=by_curve if kept else None)
    found = curve_instead(study, state, stub(), stub())
    assert (found is not None and found[0].current is curve.fitted) is kept


@pytest.mark.parametrize(("left", "stands"), [(0.04, True), (0.08, False)])
def test_beside_a_law_that_lasted_a_curve_has_to_leave_half_of_what_that_leaves(
    monkeypatch, stub, left, stands
) -> None:
    plain, bias = stub(effects=()), stub(effects=(stub(prefix="bath.bias"),))
    curve = candidate(stub, "bath.unknown", 4.0)
    step = stub(parent=plain, ranked=(curve,), taken=curve, screened=())
    monkeypatch.setattr(module, "as_fine_as_pays", lambda study, parent, ranked: ranked)
    monkeypatch.setattr(module, "sound", lambda study, ranked: True)
    monkeypatch.setattr(module, "times_noise", lambda *args: 50.0)
    monkeypatch.setattr(module, "in_order", lambda ranked, settings: ranked)
    by_it = stub(mismatch=lambda effects: left if effects else 1.0, holds=True, unstable=())
    monkeypatch.setattr(far_better, "free_runs_of", lambda *asked: by_it)
    monkeypatch.setattr(far_better, "held_out_gains", lambda state, others: {"bath.unknown": SURE})
    study = stub(settings=DiagnosisSettings(), problem=None, working_on=lambda text: None)
    by_bias = stub(mismatch=lambda effects: 0.1 if effects else 1.0)
    found = curve_instead(study, SearchState(plain, bias, (step,)), stub(), by_bias)
    assert (found is not None and found[0].current is curve.fitted) is stands


def test_no_curve_is_asked_where_none_was_tried_or_there_is_nothing_to_ask(monkeypatch, stub) -> None:
    monkeypatch.setattr(module, "times_noise", lambda *args: 50.0)
    monkeypatch.setattr(module, "sound", lambda study, ranked: True)
    plain = stub(effects=())
    ripple = candidate(stub, "cart.ripple", 2.9, unknown=False)
    state = SearchState(plain, plain, (stub(parent=plain, ranked=(ripple,), taken=ripple, screened=()),))
    study = stub(settings=DiagnosisSettings(), problem=None)
    assert curve_instead(study, state, stub(), stub()) is None
    assert curve_instead(study, state, None, stub()) is None


def test_a_curve_of_fewer_experiments_is_not_compared_with_the_model_on_more(monkeypatch, stub) -> None:
    """Seen: a traceback, "shapes (64,) (128,)", where a second experiment was taken to choose with and the effects stayed."""
    monkeypatch.setattr(module, "times_noise", lambda *args: 50.0)
    monkeypatch.setattr(module, "sound", lambda study, ranked: True)
    then, now = (stub(effects=(), fits=(stub(energies=np.ones(n)),)) for n in (64, 128))
    curve = candidate(stub, "arm_spring.unknown", 4.0)
    state = SearchState(now, now, (stub(parent=then, ranked=(curve,), taken=curve, screened=()),))
    study = stub(settings=DiagnosisSettings(), problem=None)
    assert curve_instead(study, state, stub(), stub()) is None
