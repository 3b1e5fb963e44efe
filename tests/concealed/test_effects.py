from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from experiments.concealed.case import Case, assemble, draw_case
from experiments.concealed.catalogue.arm import CATALOGUE, LIBRARY, OUTSIDE
from experiments.concealed.excitation import EXPERIMENTS, SENSOR_NOISE
from experiments.concealed.files import key
from experiments.concealed.plant_arm import Drive

BODY = {
    "viscous_friction", "coulomb_friction", "stribeck_friction", "coulomb_asymmetry", "quadratic_drag",
    "load_dependent_friction", "position_dependent_friction", "friction_warmup", "presliding_hysteresis",
    "constant_bias", "gravity", "torque_ripple", "end_stop", "additional_mode",
}  # fmt: skip
COUPLING = {"backlash", "nonlinear_stiffness", "hysteretic_spring", "nonlinear_damping", "transmission_error"}
ACTUATOR = {"input_delay", "input_lag", "input_bias", "input_gain", "torque_saturation", "actuator_deadzone"}
SENSOR = {"output_delay", "sensor_lag", "sensor_bias", "sensor_gain"}
# The contract's table; a ripple of torque is the same at the actuator and at the motor that it drives.
MECHANISMS = {
    "motor": BODY, "gearbox": BODY, "arm": BODY, "gear_spring": COUPLING, "arm_spring": COUPLING,
    "actuator": ACTUATOR | {"torque_ripple"}, "sensor": SENSOR,
}  # fmt: skip
NOT_SHOWN_BY_THESE_DATA = {"input_gain", "sensor_gain"}
SEED, SAMPLES, SAMPLE_TIME = 11, 1500, 0.001


def draw(number: int, plan: tuple[str, ...]) -> Case:
    return draw_case(SEED, number, plan, samples=SAMPLES, sample_time=SAMPLE_TIME)


@pytest.fixture(scope="module")
def difference() -> dict[str, np.ndarray]:
    """RMS by which every effect, and none, moves the measured speed in the four experiments, the torque being the same.

    The torque is what the feedback commands to the plain arm; a feedback of its own would hide a bias, say.
    """
    names = [*CATALOGUE, "none"]
    cases = [draw(i, (name,) if name != "none" else ()) for i, name in enumerate(names)]
    plain, drive = assemble([replace(case, plan=(), switches=[]) for case in cases], steps_per_sample=2)
    changed, _ = assemble(cases, steps_per_sample=4)
    rest = plain.initial_state(np.zeros((3, plain.lanes)))
    torque = plain.run(rest, drive).torque
    replay = Drive(torque, np.zeros_like(torque), drive.noise, 0.0 * drive.gain, 0.0 * drive.gain)
    before = plain.run(rest, replay).speed
    after = changed.run(changed.initial_state(np.zeros((3, changed.lanes))), replay).speed
    moved = np.sqrt(np.mean((after - before)[-SAMPLES:] ** 2, axis=0)).reshape(len(names), len(EXPERIMENTS))
    return dict(zip(names, moved, strict=True))


@pytest.mark.parametrize("name", CATALOGUE)
def test_effect_moves_the_output_by_more_than_the_noise(name: str, difference: dict[str, np.ndarray]):
    moved = difference[name]
    assert moved.max() > 3.0 * SENSOR_NOISE, dict(zip(EXPERIMENTS, moved.round(3), strict=True))


def test_no_effect_moves_nothing(difference: dict[str, np.ndarray]):
    assert difference["none"].max() < 0.1 * SENSOR_NOISE  # what is left is the two integrators' steps


@pytest.mark.parametrize("name", CATALOGUE)
def test_answers_are_in_the_contract(name: str):
    effect = CATALOGUE[name]
    assert effect.accept
    for port, mechanism in (*effect.accept, *effect.near):
        assert port in MECHANISMS
        if mechanism != "unknown":
            assert mechanism in MECHANISMS[port]
    assert not set(effect.accept) & set(effect.near)
    assert {port for port, _ in effect.accept} & set(effect.ports)
    assert all(mechanism == "unknown" for _, mechanism in effect.accept) == effect.outside


def test_every_mechanism_that_the_data_can_show_is_concealed_somewhere():
    named = {pair[1] for name in LIBRARY for pair in CATALOGUE[name].accept}
    everything = BODY | COUPLING | ACTUATOR | SENSOR
    assert everything - named == NOT_SHOWN_BY_THESE_DATA
    assert len(OUTSIDE) >= 6


def test_twins_have_each_other_among_the_answers():
    assert set(CATALOGUE["input_delay"].accept) == set(CATALOGUE["output_delay"].accept)
    assert set(CATALOGUE["input_bias"].accept) == set(CATALOGUE["constant_bias"].accept)


def test_key_of_two_effects_and_of_none():
    two = key(draw(0, ("backlash", "gravity")))
    assert two["effects"] == ["backlash", "gravity"]
    assert [len(two[name]) for name in ("accept", "near", "ports", "strength")] == [2, 2, 2, 2]
    none = key(draw(0, ()))
    assert (none["effects"], none["accept"], none["near"], none["ports"]) == (["none"], [[]], [[]], [[]])


def test_strength_scales_the_effect_and_nothing_else():
    weak, dominant = (
        draw_case(SEED, 3, ("gravity",), samples=200, strength=word, sample_time=SAMPLE_TIME)
        for word in ("weak", "dominant")
    )
    assert weak.truth == dominant.truth
    assert weak.switches[0]["moment"] < 0.2 * dominant.switches[0]["moment"]
    assert weak.switches[0]["angle"] == dominant.switches[0]["angle"]
