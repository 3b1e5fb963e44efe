"""A model with effects to which further ones are attached: kept, restored and exported, it stays the same model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.mechanisms.actuator import InputDelay, InputGain, InputLag, TorqueSaturation
from greybox_torch.mechanisms.attached import attached
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.mechanisms.sensor import OutputDelay, SensorBias, SensorGain, SensorLag
from greybox_torch.mechanisms.stored import in_layers, restored_model, stored_effects
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.varying_friction import FrictionWarmup
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import RobotArm
from tests.mechanisms.attaching import ARM, ARM_START, STEP, Tank, at, free_run, records_of, starts

GAP = "gear_spring.backlash.half_gap"
VALUES = {
    "torque_saturation.limit": 1.2,
    "input_lag.T": 8 * STEP,
    "input_gain.gain_error": 0.3,
    "sensor_bias.bias": 0.5,
    "sensor_gain.gain_error": 0.4,
    "sensor_lag.T": 6 * STEP,
    "input_delay.T": 7 * STEP,
    "output_delay.T": 5 * STEP,
    "friction_warmup.delta": 0.3,
}


def layers(around: Surroundings, inner: Mechanism, outer: Mechanism, port: str, wider: float) -> AugmentedModel:
    """``outer`` attached to a tank that has ``inner`` at the same port, where signals have gone ``wider`` times as far since."""
    ports = {p.name: around for p in Tank().all_ports}
    ranges = {n: Range(wider * r.low, wider * r.high, wider * r.rms) for n, r in around.ranges.items()}
    base = AugmentedModel(Tank(), [at(port, inner)], ports)
    return AugmentedModel(base, [at(port, outer)], {name: replace(around, ranges=ranges) for name in ports})


def run_of(model: GreyBoxModel) -> np.ndarray:
    own = {p.name: 0.05 * k for k, p in enumerate(q for q in model.declared_parameters if ".w_" in q.name)}
    given = [
        own.get(p.name, next((v for n, v in VALUES.items() if n in p.name), p.value)) for p in model.declared_parameters
    ]
    records, p = records_of(80), np.array(given)
    x0 = model.begun(starts(model, np.array([[1.0]])), model.prepared(records, p), np.zeros(1, dtype=np.int64), p)
    return free_run(model, records, p, x0)[0]


@pytest.mark.parametrize(
    ("inner", "outer", "port"),
    [
        (TorqueSaturation(), InputLag(), "actuator"),
        (InputLag(), TorqueSaturation(), "actuator"),
        (TorqueSaturation(), InputGain(), "actuator"),
        (SensorBias(), SensorGain(), "sensor"),
        (SensorGain(), SensorBias(), "sensor"),
        (TorqueSaturation(), InputDelay(), "actuator"),
        (InputDelay(), TorqueSaturation(), "actuator"),
        (Unknown("input", knots=5), InputGain(), "actuator"),
    ],
)
def test_what_is_kept_is_restored_as_it_was(around, inner, outer, port) -> None:
    """The law attached last comes first at an actuator and last at a sensor; a curve keeps the range that it was learned over."""
    model = layers(around, inner, outer, port, 1.7)
    again = restored_model(Tank(), stored_effects(model))
    assert [p.name for p in again.declared_parameters] == [p.name for p in model.declared_parameters]
    np.testing.assert_array_equal(run_of(again), run_of(model))
    swapped = layers(around, outer, inner, port, 1.0)
    assert np.abs(run_of(swapped) - run_of(model)).max() > 1e-3, "the order can be seen"


@pytest.mark.parametrize(
    ("inner", "outer", "port"),
    [
        (TorqueSaturation(), InputLag(), "actuator"),
        (InputLag(), InputGain(), "actuator"),
        (TorqueSaturation(), InputDelay(), "actuator"),
        (SensorBias(), SensorGain(), "sensor"),
        (SensorLag(), OutputDelay(), "sensor"),
    ],
)
def test_one_layer_in_the_order_of_all_effects_does_the_same(around, inner, outer, port) -> None:
    model = layers(around, inner, outer, port, 1.0)
    plain, effects, surroundings = attached(model)
    np.testing.assert_allclose(run_of(AugmentedModel(plain, effects, surroundings)), run_of(model), rtol=1e-12)


def test_effects_without_layers_are_kept_as_before(around) -> None:
    model = AugmentedModel(Tank(), [at("actuator", InputLag())], {"actuator": around})
    (entry,) = stored_effects(model)
    assert "layer" not in entry
    assert in_layers([], [entry]) == [entry]
    assert [e.get("layer", 0) for e in in_layers(in_layers([entry], [entry]), [entry])] == [0, 1, 2]


def test_a_gap_that_is_wider_than_what_was_measured_is_restored(around) -> None:
    place = replace(around, unmeasured=frozenset({"deflection"}))
    wide = 5.0 * around.ranges["deflection"].reach
    model = AugmentedModel(
        RobotArm(), [at("gear_spring", Backlash(as_force=True))], {"gear_spring": place}, start={GAP: wide}
    )
    again = restored_model(RobotArm(), stored_effects(model))
    upper = [next(p.upper for p in m.declared_parameters if p.name == GAP) for m in (model, again)]
    assert upper[0] == upper[1] > wide


def test_an_effect_of_a_kind_that_is_there_already_has_a_name_of_its_own(around) -> None:
    """Seen: two laws of one name at one port, whose parameters could not be told apart."""
    model: GreyBoxModel = Tank()
    for k, label in enumerate(("", "_2", "_3")):
        made = attach(model, "actuator", InputLag())
        assert made.label == label
        model = AugmentedModel(model, [made], {"actuator": around})
        assert len({p.name for p in model.declared_parameters}) == len(Tank().declared_parameters) + k + 1
    assert attach(model, "actuator", InputGain()).label == ""
    late = attach(Tank(), "actuator", InputDelay(), label="_of_all")
    again = attach(AugmentedModel(Tank(), [late], {"actuator": around}), "actuator", InputDelay(), label="_of_all")
    assert (late.label, again.label) == ("_of_all", "_of_all_2")


def test_a_model_with_a_dead_time_has_the_ports_of_the_machine(around) -> None:
    """Seen: the channels of the delayed input were ports, and the input's own had another name."""
    model = AugmentedModel(Tank(), [at("actuator", InputDelay())], {"actuator": around})
    assert [p.name for p in model.all_ports] == [p.name for p in Tank().all_ports]


def test_time_is_one_state_in_whatever_layer_it_is_needed(around) -> None:
    """Seen: a model whose friction warms up could not be given another law of time: "names time twice"."""
    laws = [at("motor", FrictionWarmup()), at("gearbox", FrictionWarmup())]
    places = {a.port: around for a in laws}
    layered, flat = (
        AugmentedModel(AugmentedModel(ARM, laws[:1], places), laws[1:], places),
        AugmentedModel(ARM, laws, places),
    )
    assert [s.name for s in layered.states] == [s.name for s in flat.states]
    assert [s.name for s in layered.states].count("time") == 1
    records, p = records_of(300), np.array([0.3 if "delta" in q.name else q.value for q in flat.declared_parameters])
    runs = [free_run(m, records, p, starts(m, ARM_START)) for m in (layered, flat)]
    np.testing.assert_allclose(*runs, rtol=1e-12)
    assert np.abs(runs[0] - free_run(ARM, records, p[: len(ARM.declared_parameters)], ARM_START)).max() > 1e-3
