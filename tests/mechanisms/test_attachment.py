"""The model that results from attaching mechanisms to ports."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem, problem_for
from greybox_torch.mechanisms.actuator import InputDelay, InputLag, TorqueSaturation
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import AdditionalMode, ConstantBias, TorqueRipple
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Surroundings
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sensor import SensorGain, SensorLag
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.varying_friction import FrictionWarmup
from greybox_torch.model import Balance, Body, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import RobotArm

STEP = 1e-3
ARM = RobotArm()
ARM_START = np.array([[0.02, -0.01, 6.0, 5.0, 4.0]])


class Tank(GreyBoxModel):
    states = [State("level", "m", initial=1.0)]
    inputs = [Input("pump", "m/s")]
    outputs = [Output("level", "m")]
    parameters = [Parameter("k", 0.3, "1/s")]
    ports = [Balance("water", level="level")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"level": u.pump - p.k * x.level + port.water}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"level": x.level}


def records_of(samples: int, lengths: tuple[int, ...] = (), hold: str = "zoh", step: float = STEP) -> Records:
    t = step * np.arange(samples)
    u = 3.0 * np.sin(9.0 * t) + np.sin(170.0 * t + 1.0)
    sizes = np.array(lengths or (samples,))
    last = np.cumsum(sizes) - 1
    steps = np.full(samples, step)
    return Records(u[None], np.zeros((1, samples)), steps, last - sizes + 1, last, ("",) * len(sizes), hold)


def attached(model: GreyBoxModel, around: Surroundings, *effects: Attachment, **options: Any) -> AugmentedModel:
    return AugmentedModel(model, effects, {e.port: around for e in effects}, **options)


def values_of(model: GreyBoxModel, **given: float) -> np.ndarray:
    """The model's parameter values, some given by the end of their name."""
    values = dict(model.values())
    for end, value in given.items():
        (name,) = [n for n in values if n.endswith(f".{end}") or n == end]
        values[name] = value
    return np.array(list(values.values()))


def starts(model: GreyBoxModel, base: np.ndarray, **given: float) -> np.ndarray:
    rest = [given.get(s.name.rpartition(".")[2], 0.0) for s in model.states[base.shape[1] :]]
    return np.hstack([base, np.tile(rest, (len(base), 1))])


def free_run(model: GreyBoxModel, records: Records, p: np.ndarray, x0: np.ndarray, stepper: Any = None) -> np.ndarray:
    stepper = stepper or EagerStepper.of(model, (), "cpu", "double")
    return stepper.run(model.prepared(records, p), Pass(whole_records(records), p, x0)).y[:, :, 0]


def at(port: str, mechanism: Mechanism, **rest: Any) -> Attachment:
    return Attachment(port, mechanism, **rest)


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


class Cart(GreyBoxModel):
    """Two inputs in one unit, outputs as given."""

    states = [State("place", "m"), State("speed", "m/s")]
    inputs = [Input("push", "N"), Input("pull", "N")]
    parameters = [Parameter("m", 2.0, "kg")]
    ports = [Body("cart", speed="speed", position="place")]

    def __init__(self, *outputs: Output) -> None:
        self.outputs = list(outputs)
        super().__init__()

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"place": x.speed, "speed": (u.push - u.pull + port.cart) / p.m}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {o.name: x.place if o.unit == "m" else x.speed for o in self.outputs}


@pytest.mark.parametrize(
    ("outputs", "port", "mechanism", "expected"),
    [
        ([Output("place", "m")], "actuator.pull", InputLag(), 30.0),
        ([Output("place", "m"), Output("again", "m")], "sensor.again", SensorLag(), 7.0),
        ([Output("place", "m"), Output("tacho", "m/s")], "cart", AdditionalMode(), 20.0),
        ([Output("place", "m")], "cart", AdditionalMode(), 20.0),  # nothing measures the speed
    ],
)
def test_memory_begins_settled(around, data_set, outputs, port, mechanism, expected) -> None:
    cart = Cart(*outputs)
    signals = {"push": 40.0, "pull": 30.0, **{o.name: 10.0 for o in outputs}}
    units = {i.name: i.unit for i in (*cart.inputs, *outputs)}
    dataset = data_set(
        units,
        [{name: np.full(20, value) for name, value in signals.items()}],
        initial={"place": {"value": 7.0}, "speed": {"value": 20.0}},
    )
    problem = make_problem(dataset, cart, dataset.recordings)
    assert problem_for(problem, attached(cart, around, at(port, mechanism)), {}).initial[0, -1] == expected


def test_several_of_a_kind_are_told_apart_by_label(around) -> None:
    model = attached(ARM, around, *(at("motor", CoulombFriction(), label=f"#{k}") for k in (1, 2)))
    assert [p.name for p in model.declared_parameters[13:]] == [
        f"motor.coulomb_friction#{k}.{n}" for k in (1, 2) for n in ("F_c", "v_0")
    ]


def test_port_that_is_not_there(around) -> None:
    with pytest.raises(UserError, match=r"model robot_arm has no port 'wheel' \(it has: motor, gearbox, arm, gear_s"):
        attached(ARM, around, at("wheel", CoulombFriction()))


def test_start_values_replace_the_declared_within_bounds(around) -> None:
    friction = at("motor", CoulombFriction())
    model = attached(ARM, around, friction, start={"motor.coulomb_friction.F_c": -3.0, "F_v": 0.5})
    assert (model.values()["motor.coulomb_friction.F_c"], model.values()["F_v"]) == (0.0, 0.5)


class ArmWithPlay(RobotArm):
    """The arm once more, with a dead zone written into its gear spring."""

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        speed = x.motor_speed
        rub = p.F_v * speed + (p.F_c + p.F_cs / torch.cosh(p.alpha * speed)) * torch.tanh(p.beta * speed)
        beyond = torch.sign(x.gear_twist) * torch.clamp(torch.abs(x.gear_twist) - 0.005, min=0.0)
        gear = p.k_g1 * beyond + p.k_g3 * beyond**3 + p.d_g * (speed - x.gearbox_speed)
        arm = p.k_a * x.arm_twist + p.d_a * (x.gearbox_speed - x.arm_speed)
        return {
            "gear_twist": speed - x.gearbox_speed,
            "arm_twist": x.gearbox_speed - x.arm_speed,
            "motor_speed": (u.torque - rub - gear) / (p.J * p.a_m),
            "gearbox_speed": (gear - arm) / (p.J * p.a_g),
            "arm_speed": arm / (p.J * (1 - p.a_m - p.a_g)),
        }


def test_backlash_is_a_dead_zone_in_the_spring_and_nothing_else(around) -> None:
    model = attached(ARM, around, EFFECTS[0])
    records = records_of(300)
    augmented = free_run(
        model, records, values_of(model, half_gap=0.005, k_g3=40.0), ARM_START, make_stepper(model, ())
    )
    written = ArmWithPlay()
    expected = free_run(written, records, values_of(written, k_g3=40.0), ARM_START, make_stepper(written, ()))
    without = free_run(ARM, records, values_of(ARM, k_g3=40.0), ARM_START)
    np.testing.assert_allclose(augmented, expected, rtol=0, atol=1e-12)
    assert np.abs(augmented - without).max() > 0.1


@pytest.mark.parametrize("hold", ["zoh", "foh"])
@pytest.mark.parametrize("samples", [0.0, 3.0, 2.4])
def test_delay_shifts_the_input(around, samples, hold) -> None:
    model = attached(Tank(), around, at("actuator", InputDelay()))
    records = records_of(90, (50, 40), hold)
    u, index = records.u[0], np.arange(50.0)
    shifted = [np.interp(index[:n] - samples, index[:n], part) for n, part in ((50, u[:50]), (40, u[50:]))]
    late = replace(records, u=np.concatenate(shifted)[None])
    x0 = np.array([[1.0], [0.4]])
    delayed = free_run(model, records, values_of(model, T=samples * STEP), x0)
    expected = free_run(Tank(), late, values_of(Tank()), x0)
    known = np.arange(50) < np.array([[50], [40]])
    np.testing.assert_allclose(delayed[known], expected[known], rtol=0, atol=1e-14)


def test_what_was_put_in_before_a_record_is_not_known(around) -> None:
    """Seen: a record under way; the torque of its first moments fell on a late actuator, whose delay was then taken for a sensor's."""
    delay = at("actuator", InputDelay())
    records = records_of(90, (50, 40))
    model = attached(Tank(), around, delay)
    missing = np.isnan(model.prepared(records, values_of(model, T=2.4 * STEP)).y[0])
    assert np.flatnonzero(missing).tolist() == [0, 1, 2, 50, 51, 52]
    looked_at = attached(Tank(), around, delay, probed=[delay])
    assert not np.isnan(looked_at.prepared(records, values_of(looked_at, T=2.4 * STEP)).y).any()


def of_kind(mechanism: Mechanism) -> tuple[GreyBoxModel, np.ndarray, Attachment]:
    """A model with a port that the mechanism fits, its start state, and the attachment."""
    kind, position = mechanism.kinds[0], "motor" if "position" in mechanism.needs else ""
    if kind == "balance":
        return Tank(), np.ones((1, 1)), at("water", mechanism)
    port = {"body": "motor", "coupling": "gear_spring"}.get(kind, kind)
    shifted = "+gear_twist" if mechanism.kinematic else ""
    return ARM, ARM_START, at(port, mechanism, position=position, shifted_state=shifted)


@pytest.fixture(scope="module")
def plain() -> dict[str, np.ndarray]:
    records = records_of(8)
    arm, tank = (free_run(m, records, values_of(m), x) for m, x in ((ARM, ARM_START), (Tank(), np.ones((1, 1)))))
    return {"robot_arm": arm, "Tank": tank}


@pytest.mark.parametrize("mechanism", [pytest.param(m(), id=m.name) for m in LIBRARY.values()])
def test_changes_nothing_at_zero_amplitude(mechanism, around, plain) -> None:
    base, x0, effect = of_kind(mechanism)
    probe = mechanism.probes(around)[0]
    model = attached(base, around, effect, probed=[effect])
    assert model.parameter_name(effect, SHARE) in model.values()
    zero = {f"{effect.prefix}.{name}": 0.0 for name in probe.directions}
    own = {f"{effect.prefix}.{name}": value for name, value in probe.values.items()}
    p = values_of(model, **own, **zero)
    assert np.array_equal(free_run(model, records_of(8), p, starts(model, x0, lagged=2.0)), plain[base.title])


@pytest.mark.parametrize("mechanism", [pytest.param(m(), id=m.name) for m in LIBRARY.values()])
def test_acts_on_the_output(mechanism, around, plain) -> None:
    base, x0, effect = of_kind(mechanism)
    model = attached(base, around, effect)
    size = {name: 0.004 for probe in mechanism.probes(around) for name in probe.directions if name != SHARE}
    size |= {name: 0.5 for name in ("limit", "threshold", "where") if name in mechanism.probes(around)[0].values}
    size |= {"side": -1.0} if mechanism.name == "end_stop" else {}
    p = values_of(model, **{f"{effect.prefix}.{n}": v for n, v in size.items()})
    changed = free_run(model, records_of(8), p, starts(model, x0, lagged=2.0, bristle=0.1, slip=0.1, stretch=0.1))
    assert np.abs(changed - plain[base.title]).max() > 1e-9


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
    records = records_of(60)
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


@pytest.mark.parametrize(("share", "conserved"), [(1.0, True), (0.0, False)])
def test_transmission_error_with_its_whole_reaction_neither_makes_nor_loses_energy(around, share, conserved) -> None:
    """Virtual work: an arm without friction, dampers and input keeps its energy."""
    error = Attachment("gear_spring", TransmissionError(3.0), position="motor", shifted_state="+gear_twist")
    model = attached(ARM, around, error)
    none = {"F_v": 0.0, "F_c": 0.0, "F_cs": 0.0, "d_g": 0.0, "d_a": 0.0}
    p = values_of(model, **none, a=0.02, b=0.01, reaction=share)
    records = replace(records_of(2000), u=np.zeros((1, 2000)))
    x0 = starts(model, np.array([[0.3, 0.0, 6.0, 5.0, 4.0]]))
    stepper = EagerStepper.of(model, (), "cpu", "double")
    states = stepper.run(records, Pass(whole_records(records), p, x0, keep_states=True)).states
    assert states is not None
    value = dict(zip((q.name for q in model.declared_parameters), p, strict=True))
    gear, arm, *speeds, angle = states[0].T
    twist = gear + 0.02 * np.cos(3.0 * angle) + 0.01 * np.sin(3.0 * angle)
    shares = (value["a_m"], value["a_g"], 1 - value["a_m"] - value["a_g"])
    energy = 0.5 * value["k_g1"] * twist**2 + 0.25 * value["k_g3"] * twist**4 + 0.5 * value["k_a"] * arm**2
    energy += sum(0.5 * value["J"] * s * w**2 for s, w in zip(shares, speeds, strict=True))
    assert (np.ptp(energy) < 1e-5 * energy[0]) == conserved
    assert (np.ptp(energy) > 1e-3 * energy[0]) != conserved
