"""Two laws of one port that are one law in a richer form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.beliefs import NO_BELIEFS
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.forms import forms_of_both
from greybox_torch.diagnosis.select.richer import as_one_law, richer_instead, with_richer_form
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction
from greybox_torch.mechanisms.varying_friction import FrictionWarmup, PositionDependentFriction

from ..conftest import found


@pytest.mark.parametrize("second", [ConstantBias, CoulombAsymmetry])
@pytest.mark.parametrize(("level", "difference"), [(0.1, 0.04), (0.04, 0.1)])
def test_dry_friction_and_what_makes_it_uneven_are_one_law(motor_data, motor, begun, second, level, difference) -> None:
    """Seen: a bridge's bearing, 44 N m one way and 83 the other, told as Coulomb friction and a constant force that is part of it."""

    def lacking(q: float, v: float) -> float:
        return -level * np.tanh(v / 0.05) - difference * np.tanh(v / 0.05) ** 2

    search = begun(motor_data(torque=lacking), motor)
    dry, further = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", second())
    before = found(search, dry, {f"{dry.prefix}.F_c": level})
    assert result_of(with_richer_form(search.study, before)) is before, "only in the place of two"
    both = search.refitted((dry, further), before.current)
    taken = judged(Candidate(further, (), 0.5), before.current, both, search.study.settings)
    step = SelectionStep((), before.current, (taken,), taken)
    state = richer_instead(search.study, before, replace(before.at(both), steps=(*before.steps, step)))
    if difference > level:
        assert state is None, "friction does not push"
        return
    assert state is not None and state.prefixes == {"rotor.coulomb_asymmetry"}
    values = state.current.values()
    assert values["rotor.coulomb_asymmetry.F_c"] == pytest.approx(level, rel=0.05)
    assert values["rotor.coulomb_asymmetry.delta"] == pytest.approx(difference, rel=0.05)


def test_a_level_that_stays_and_one_that_fades_are_asked_as_one_law(motor_data, motor, begun) -> None:
    """Seen: a centrifuge's bearing, told as friction that warms up and, beside it, Coulomb friction (0.97 each)."""
    search = begun(motor_data(torque=lambda q, v: -0.1 * np.tanh(v / 0.05)), motor)
    level, fading = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", FrictionWarmup())
    before = found(search, fading, {f"{fading.prefix}.delta": 0.05})
    after = before.at(search.refitted((fading, level), before.current))
    asked = forms_of_both(fading, level, before, after, NO_BELIEFS)
    forms = {law.mechanism.stands_for: start for law, start in asked}
    start = forms[("coulomb_friction", "friction_warmup")]
    values = after.current.values()
    assert start["rotor.friction_warmup.F_c"] == values[f"{level.prefix}.F_c"] == pytest.approx(0.1, rel=0.2)
    assert start["rotor.friction_warmup.delta"] == values[f"{fading.prefix}.delta"]


@pytest.mark.parametrize("first", ["level", "varying"])
def test_a_mean_level_and_what_varies_with_position_are_one_law_whichever_comes_first(
    motor_data, motor, begun, first
) -> None:
    """Seen: a blanket cylinder that rubs four times as much along half a turn, told as dry friction there and at the motor."""

    def lacking(q: float, v: float) -> float:
        return -(0.1 + 0.06 * np.sin(8.0 * q)) * np.tanh(v / 0.05)

    search = begun(motor_data(torque=lacking), motor)
    level, varying = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", PositionDependentFriction(8.0))
    starts = {level: {f"{level.prefix}.F_c": 0.1}, varying: {f"{varying.prefix}.b": 0.06}}
    one, other = (level, varying) if first == "level" else (varying, level)
    before = found(search, one, starts[one])
    both = search.refitted(
        (one, other), before.current, [{**before.current.values(), **starts[level], **starts[varying]}]
    )
    taken = judged(Candidate(other, (), 0.5), before.current, both, search.study.settings)
    step = SelectionStep((), before.current, (taken,), taken)
    state = richer_instead(search.study, before, replace(before.at(both), steps=(*before.steps, step)))
    assert state is not None and state.prefixes == {varying.prefix}
    values = {n.removeprefix(f"{varying.prefix}."): v for n, v in state.current.values().items()}
    assert values["F_c"] == pytest.approx(0.1, rel=0.1)
    assert np.hypot(values["a"], values["b"]) == pytest.approx(0.06, rel=0.1)


@pytest.mark.parametrize("known", [True, False])
def test_what_has_become_a_mean_level_since_is_asked_with_what_varies_again(motor_data, motor, begun, known) -> None:
    """Seen: the friction of a crane's slewing ring, found as Stribeck friction, which lost its peak, and friction over the position."""

    def lacking(q: float, v: float) -> float:
        return -(0.1 + 0.06 * np.sin(8.0 * q)) * np.tanh(v / 0.05)

    search = begun(motor_data(torque=lacking), motor)
    level, varying = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", PositionDependentFriction(8.0))
    before = found(search, level, {f"{level.prefix}.F_c": 0.1})
    start = {**before.current.values(), f"{varying.prefix}.b": 0.06}
    both = search.refitted((level, varying), before.current, [start])
    taken = judged(Candidate(varying, (), 0.5), before.current, both, search.study.settings)
    steps = (*before.steps, SelectionStep((), before.current, (taken,), taken), SelectionStep((), both, (), None))
    without = {varying.prefix: before.current} if known else {}
    state = replace(before.at(both), steps=steps, without=without)
    one = as_one_law(search.study, state)
    assert one.prefixes == ({varying.prefix} if known else {level.prefix, varying.prefix})
    if known:
        assert one.current.values()[f"{varying.prefix}.F_c"] == pytest.approx(0.1, rel=0.1)
    else:
        assert one is state
