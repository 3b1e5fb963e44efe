"""An arm with effects of all kinds at once: its names, its run and its sensitivities by every stepper."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.actuator import InputDelay, InputLag, TorqueSaturation
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sensor import SensorGain, SensorLag
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.varying_friction import FrictionWarmup
from greybox_torch.model import Signals
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records
from tests.mechanisms.attaching import ARM, ARM_START, at, attached, free_run, records_of, starts, values_of

EFFECTS = (
    at("gear_spring", Backlash(), shifted_state="+gear_twist"),
    at("motor", PreslidingHysteresis()),
    at("arm", TorqueRipple(3.0), position="arm"),
    at("gearbox", FrictionWarmup()),
    at("actuator", InputDelay()),
    at("sensor", SensorLag()),
)
SENSITIVE = (
    "k_g1",
    "gear_spring.backlash.half_gap",
    "motor.presliding_hysteresis.F",
    "motor.presliding_hysteresis.z_0",
    "arm.torque_ripple.a",
    "arm.torque_ripple.order",
    "gearbox.friction_warmup.T",
    "actuator.input_delay.T",
    "sensor.sensor_lag.T",
)
SIZES = {
    "half_gap": 0.005,
    "F": 0.6,
    "z_0": 0.04,
    "a": 0.5,
    "delta": 0.3,
    "input_delay.T": 0.0034,
    "friction_warmup.T": 0.3,
    "sensor_lag.T": 0.004,
}


@pytest.fixture(scope="module")
def full(around: Surroundings) -> tuple[AugmentedModel, np.ndarray, np.ndarray]:
    """The arm with effects of all kinds: kinematic, with memory, with position, with time, at the input, at the output."""
    model = attached(ARM, around, *EFFECTS)
    return model, values_of(model, **SIZES), starts(model, ARM_START, lagged=6.0, bristle=0.01)


@pytest.fixture(scope="module")
def compiled(full) -> NativeStepper:
    stepper = make_stepper(full[0], SENSITIVE)
    assert isinstance(stepper, NativeStepper)
    return stepper


def test_names(full) -> None:
    model = full[0]
    assert [s.name for s in model.states[5:]] == [
        "arm.position",
        "time",
        "motor.presliding_hysteresis.bristle",
        "sensor.sensor_lag.lagged",
    ]
    assert [i.name for i in model.inputs[1:]] == [f"actuator.input_delay.{n}" for n in ("delayed", "slope", "delay")]
    assert [p.name for p in model.declared_parameters][:13] == [p.name for p in ARM.declared_parameters]
    assert set(SENSITIVE) < {p.name for p in model.declared_parameters}
    assert [o.name for o in model.outputs] == ["motor_speed"]
    assert model.title == "robot_arm"
    units = {s.name: s.unit for s in model.states}
    assert (units["arm.position"], units["time"]) == ("rad", "s")


def test_native_and_eager_agree(full, compiled) -> None:
    model, p, x0 = full
    records = records_of(40)
    prepared = model.prepared(records, p)
    options = {"tangents": True, "start_directions": np.eye(x0.shape[1])[None]}
    fast = compiled.run(prepared, Pass(whole_records(records), p, x0, **options))
    slow = EagerStepper.of(model, SENSITIVE, "cpu", "double").run(
        prepared, Pass(whole_records(records), p, x0, **options)
    )
    np.testing.assert_allclose(fast.y, slow.y, rtol=1e-11, atol=1e-11)
    assert fast.dy is not None and slow.dy is not None
    scale = np.abs(slow.dy).max(axis=(0, 1, 2))
    assert (scale > 0).all()
    np.testing.assert_allclose(fast.dy / scale, slow.dy / scale, rtol=0, atol=1e-10)


def test_native_and_odeint_agree(full, compiled, around) -> None:
    _, p, x0 = full
    model = attached(ARM, around, *EFFECTS)
    records = records_of(30)
    prepared = model.prepared(records, p)
    fine = compiled.run(prepared, Pass(whole_records(records), p, x0), substeps=16).y[0, :, 0]
    model.set_values(dict(zip(model.values(), p, strict=True)))
    with torch.no_grad():
        reference = solve(model, prepared, whole_records(records), torch.as_tensor(x0.T), method="dopri5")
    np.testing.assert_allclose(fine, reference[0, :, 0].numpy(), rtol=0, atol=1e-5)


@pytest.mark.parametrize("name", SENSITIVE)
def test_tangents_are_differences(full, compiled, name) -> None:
    model, p, x0 = full
    records, index = records_of(200), list(model.values()).index(name)

    def output(value: float) -> np.ndarray:
        moved = p.copy()
        moved[index] = value
        return free_run(model, records, moved, x0, compiled)[0]

    step = 1e-6 * p[index]
    expected = (output(p[index] + step) - output(p[index] - step)) / (2 * step)
    run = compiled.run(model.prepared(records, p), Pass(whole_records(records), p, x0, tangents=True))
    assert run.dy is not None
    tangent = run.dy[0, :, 0, SENSITIVE.index(name)]
    assert np.abs(expected).max() * abs(p[index]) > 1e-4
    # play and delay have kinks: a difference across one is off by a step's worth of it
    np.testing.assert_allclose(tangent, expected, rtol=0, atol=1e-4 * np.abs(expected).max())


def test_tangents_of_effects_that_are_not_there(around) -> None:
    """The screen's shortcut: only tangents of amplitudes that are zero, compiled, against all of it in torch operations."""
    effects = [
        at("gear_spring", Backlash(), shifted_state="+gear_twist"),
        at("actuator", InputLag()),
        at("actuator", TorqueSaturation()),
        at("sensor", SensorGain()),
        at("motor", ConstantBias()),
    ]
    model = attached(ARM, around, *effects, probed=effects)
    names = ["k_a", *(f"{e.prefix}.{SHARE}" for e in effects[:3]), "sensor.sensor_gain.gain_error"]
    names.append("motor.constant_bias.bias")
    p = values_of(model, half_gap=0.005, limit=1.0, **{f"{e.prefix}.{SHARE}": 0.0 for e in effects[:3]})
    x0, records = starts(model, ARM_START, lagged=1.0), records_of(40)
    fast = make_stepper(model, names, at_zero=names[1:])
    assert isinstance(fast, NativeStepper)
    runs = [
        s.run(records, Pass(whole_records(records), p, x0, tangents=True)).dy
        for s in (fast, EagerStepper.of(model, names, "cpu", "double"))
    ]
    assert (np.abs(runs[1]).max(axis=(0, 1, 2)) > 0).all()
    np.testing.assert_allclose(runs[0], runs[1], rtol=1e-9, atol=1e-9)


def test_curve_and_local_signals(full, around) -> None:
    model, p, _ = full
    own = Signals("parameter", {n: torch.tensor(v) for n, v in zip(model.values(), p, strict=True)})
    twist = torch.linspace(-0.01, 0.01, 5, dtype=torch.float64)
    lost = model.curve(EFFECTS[0], {"deflection": twist}, own)
    np.testing.assert_allclose(lost, [0.005, 0.005, 0.0, -0.005, -0.005], atol=1e-15)
    x = Signals("state", {s.name: torch.tensor([float(k)]) for k, s in enumerate(model.states)})
    u = Signals("input", {i.name: torch.zeros(1) for i in model.inputs})
    assert float(model.local_signals(EFFECTS[0], x, u, own)["deflection"]) == 0.0
    assert float(model.local_signals(EFFECTS[1], x, u, own)["speed"]) == 2.0
    assert float(model.local_signals(EFFECTS[2], x, u, own)["position"]) == 5.0
    assert float(model.local_signals(EFFECTS[3], x, u, own)["time"]) == 6.0


def test_start_positions_tried(full, around) -> None:
    assert attached(ARM, around, EFFECTS[0]).start_trials(values_of(attached(ARM, around, EFFECTS[0]))) == []
    ripple = attached(ARM, around, EFFECTS[2])
    trials = [t["arm.position"] for t in ripple.start_trials(values_of(ripple, order=4.0))]
    assert trials[0] == 0.0 and len(trials) == 12
    np.testing.assert_allclose(np.diff(trials), 2 * np.pi / 4.0 / 12)


def test_constraint_of_the_base_is_kept(full) -> None:
    model = full[0]
    values = Signals("parameter", {**model.values(), "a_m": 0.5, "a_g": 0.6})
    assert all(v < 0 for v in model.admissible(values).values())
