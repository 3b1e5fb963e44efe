"""A law that another one contains is asked in as fine steps as it needs."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import simpler_laws
from greybox_torch.diagnosis.confirm.held_out import Gain, pooled
from greybox_torch.diagnosis.confirm.simpler_laws import _contained, _with_rival, simplified
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import finer_steps
from greybox_torch.diagnosis.select.choice import simplest
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.balance import LinearLeak, ThresholdFlow
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.model import Balance, GreyBoxModel, Input, Output, Parameter, State

WIDTH = 0.006
"""In rad/s: within it friction of 0.05 N m changes its sign, faster than one step a sample can follow."""


@pytest.mark.parametrize(("times", "finer"), [(5.0, True), (1.0, False)], ids=["much is left", "noise is left"])
def test_dry_friction_that_changes_its_sign_within_a_step_is_asked_in_finer_ones(
    monkeypatch, motor_data, motor, begun, times, finer
) -> None:
    """Seen: a press's dry friction, told as presliding of 18 um (0.97): in one step a sample it left eight times the error."""
    search = begun(motor_data(torque=lambda q, v: -0.05 * np.tanh(v / WIDTH), noise=0.002), motor)
    ranked = []
    for law, values in ((PreslidingHysteresis(), {"F": 0.05}), (CoulombFriction(), {"F_c": 0.05, "v_0": 0.05})):
        effect = attach(motor, "rotor", law)
        start = search.plain.values() | {f"{effect.prefix}.{n}": v for n, v in values.items()}
        fitted = search.refitted((effect,), search.plain, [start])
        ranked.append(judged(Candidate(effect, (), 0.9), search.plain, fitted, search.study.settings))
    state = search.at(ranked[0].fitted, steps=(SelectionStep((), search.plain, tuple(ranked), ranked[0]),)).state
    monkeypatch.setattr(finer_steps, "times_noise", lambda problem, fitted, settings: times)
    (rival, fitted), (sticking, _) = _contained(search.study, state, state.effects[0])
    assert sticking.candidate.attachment.mechanism.options() == {"sticking": True}
    assert rival is ranked[1] and fitted.effects[0].mechanism.name == "coulomb_friction"
    assert (fitted.effects[0].substeps > 1) is finer
    if finer:
        assert fitted.score < rival.fitted.score - 0.5
        assert fitted.values()["rotor.coulomb_friction.v_0"] == pytest.approx(WIDTH, rel=0.1)


@pytest.mark.parametrize(("z_0", "sticks"), [(3e-5, True), (0.05, False)], ids=["dry friction that sticks", "bristles"])
def test_bristles_too_short_to_be_seen_are_dry_friction_that_sticks(motor_data, motor, begun, z_0, sticks) -> None:
    """Seen: a valve's stem that truly sticks, told as presliding of 18 um (0.97), the least that its law has."""
    bent = [0.0]

    def bristles(q: float, v: float) -> float:
        bent[0] = float(np.clip(bent[0] + v * 1e-3, -z_0, z_0))
        return -0.05 * bent[0] / z_0

    search = begun(motor_data(torque=bristles, noise=0.002), motor)
    effect = attach(motor, "rotor", PreslidingHysteresis())
    start = search.plain.values() | {f"{effect.prefix}.F": 0.05}
    fitted = search.refitted((effect,), search.plain, [start])
    found = judged(Candidate(effect, (), 0.9), search.plain, fitted, search.study.settings)
    state = search.at(fitted, steps=(SelectionStep((), search.plain, (found,), found),)).state
    ended = [h for _, h in _contained(search.study, state, state.effects[0])]
    assert bool(ended) is sticks, "bristles that windows show are no dry friction"
    assert all(h.values()["rotor.coulomb_friction.F_c"] == pytest.approx(0.05, rel=0.1) for h in ended)


class Vessel(GreyBoxModel):
    """A dh/dt = q: nothing flows off."""

    states = [State("level", "m", initial="measured")]
    inputs = [Input("inflow", "m^3/s")]
    outputs = [Output("level", "m")]
    parameters = [Parameter("A", 0.5, unit="m^2", lower=0.0)]
    ports = [Balance("vessel", level="level")]

    def derivative(self, x, u, p, port):
        return {"level": (u.inflow + port.vessel) / p.A}

    def output(self, x, u, p):
        return {"level": x.level}


@pytest.mark.parametrize(
    ("threshold", "least", "leaks"), [(1.05, 0.2, True), (2.5, -0.8, False)], ids=["below nearly all", "within"]
)
def test_a_flow_above_a_threshold_below_nearly_all_levels_is_a_leak(data_set, begun, threshold, least, leaks) -> None:
    """Seen: a block's loss of heat to the air, told as a flow above 29.8 degC (0.85), as the leak that was found before was dropped."""
    rng = np.random.default_rng(4)
    inflow, level, h = np.repeat(rng.uniform(least, 1.2, 40), 50), [], 1.0
    for q in inflow:
        level.append(h)
        for _ in range(4):
            h += 0.0125 * (q - 0.4 * max(h - threshold, 0.0)) / 0.5
    noisy = np.array(level) + rng.normal(0.0, 0.005, len(level))
    data = data_set({"inflow": "m^3/s", "level": "m"}, [{"inflow": inflow, "level": noisy}], sample_time=0.05)
    search = begun(data, Vessel())
    hypotheses = []
    for law, values in ((LinearLeak(), {"reference": threshold}), (ThresholdFlow(), {"threshold": threshold})):
        effect = attach(search.problem.model, "vessel", law)
        start = search.plain.values() | {f"{effect.prefix}.{n}": v for n, v in ({"c": 0.4} | values).items()}
        fitted = search.refitted((effect,), search.plain, [start])
        hypotheses.append(judged(Candidate(effect, (), 0.9), search.plain, fitted, search.study.settings))
    leak, flow = hypotheses
    steps = (SelectionStep((), search.plain, (leak,), leak), SelectionStep((), leak.fitted, (flow,), flow))
    state = search.at(flow.fitted, steps=steps).state
    ended = _contained(search.study, state, state.effects[0])
    assert bool(ended) is leaks
    for rival, fitted in ended:
        assert fitted.values()["vessel.linear_leak.c"] == pytest.approx(0.4, rel=0.05)
        told = _with_rival(state, rival, fitted, state.effects[0])
        assert told.step_of("vessel.linear_leak") is steps[0], "its rivals are those of the step that found it"


def test_stops_at_both_ends_contain_one_at_one_end(motor_data, motor, begun) -> None:
    """Seen: the lower stop of a dancer roll, told as stops at both ends; the upper one stopped the roll in the held-out experiments."""
    search = begun(motor_data(torque=lambda q, v: 2.0 * max(2.0 - q, 0.0), noise=0.002), motor)
    low, high = (getattr(search.surroundings["rotor"].ranges["position"], end) for end in ("low", "high"))
    assert low < 1.6
    ranked = []
    for law, values in (
        (EndStop(both=True), {"k": 2.0, "low": 1.6, "high": high}),
        (EndStop(), {"k": 2.0, "where": 1.6, "side": -1.0}),
    ):
        effect = attach(motor, "rotor", law)
        start = search.plain.values() | {f"{effect.prefix}.{n}": v for n, v in values.items()}
        fitted = search.refitted((effect,), search.plain, [start])
        ranked.append(judged(Candidate(effect, (), 0.9), search.plain, fitted, search.study.settings))
    both, one = ranked
    assert both.gain > 1.0 and both.gain == pytest.approx(one.gain, abs=0.05)
    state = search.at(both.fitted, steps=(SelectionStep((), search.plain, (both, one), both),)).state
    ((rival, fitted),) = _contained(search.study, state, state.effects[0])
    assert rival is one
    assert fitted.values()["rotor.end_stop.where"] == pytest.approx(1.6, abs=0.05), (
        "the motor begins at 0.4 rad, the model at zero"
    )
    told = _with_rival(state, rival, fitted, state.effects[0])
    assert told.step_of("rotor.end_stop").taken is one, "the step is that of the law that is told"
    fewer = simplified(search.study, state, state.effects[0])
    assert fewer.current.score < both.fitted.score + 0.05, "begun at either end"
    assert not fewer.effects[0].mechanism.both
    assert simplest([both, one], search.plain, search.study.settings) is one
    state = search.at(one.fitted, steps=(SelectionStep((), search.plain, (both, one), one),)).state
    assert _contained(search.study, state, state.effects[0]) == [], "one end contains no other"


@pytest.mark.parametrize(
    ("held_out", "chosen_by", "likelihood", "meant"),
    [
        ((-0.007, 0.011), (0.008, 0.006), 3.3, "simpler"),
        ((-0.042, 0.017), (0.004, 0.002), 7.5, "simpler"),
        ((0.0, 0.01), (0.05, 0.01), 7.5, "larger"),
        ((0.0, 0.01), (0.05, 0.01), 0.0, "simpler"),
        ((0.04, 0.01), (0.0, 0.01), 0.0, "larger"),
    ],
    ids=["a stage's force", "an arm's force", "by both", "by windows that chose alone", "held out"],
)
def test_likelihood_alone_is_no_evidence_for_the_larger_law(
    monkeypatch, stub, held_out, chosen_by, likelihood, meant
) -> None:
    """Seen: constant forces told as friction that differs by direction, as a slow disturbance was counted in every sample."""
    monkeypatch.setattr(simpler_laws, "gain", lambda before, after: Gain(*chosen_by))
    monkeypatch.setattr(simpler_laws, "likelihood_significance", lambda *_: likelihood)
    by_chance = simpler_laws._by_chance(
        stub(settings=DiagnosisSettings()), stub(fits=()), stub(fits=()), Gain(*held_out)
    )
    assert by_chance is (meant == "simpler")


def test_shares_of_independent_experiments_are_weighed_by_what_is_known_of_them() -> None:
    both = pooled([Gain(0.1, 0.03), Gain(0.02, 0.04)])
    assert both.share == pytest.approx((0.1 / 9 + 0.02 / 16) / (1 / 9 + 1 / 16))
    assert both.error == pytest.approx(0.01 / (1 / 9 + 1 / 16) ** 0.5)
    assert pooled([Gain(0.1, 0.03), Gain(0.0, np.inf)]) == Gain(0.1, pytest.approx(0.03))
    assert pooled([Gain(0.0, np.inf)]).errors_away == pooled([]).errors_away == 0.0
