"""Networks at a port: friction that never drives, symmetry, zero at the start, and the same numbers on every route."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction_net import FrictionNet
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.memory_net import MemoryNet
from greybox_torch.mechanisms.network import Network
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.mechanisms.stored import attachment_json, restored_model
from greybox_torch.model import Signals
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import Windows
from greybox_torch.systems import RobotArm

UNITS = {"speed": "rad/s", "load": "N m", "position": "rad", "time": "s", "deflection": "rad", "rate": "rad/s"}
RANGES = {
    "speed": Range(-20.0, 25.0, 11.0),
    "load": Range(-8.0, 7.0, 3.0),
    "position": Range(-3.0, 5.0, 2.0),
    "time": Range(0.0, 10.0, 5.8),
    "deflection": Range(-0.06, 0.05, 0.02),
    "rate": Range(-2.0, 2.5, 1.0),
    "input": Range(-6.0, 5.0, 2.0),
    "output": Range(-20.0, 16.0, 9.0),
}
AROUND = Surroundings(RANGES, UNITS, "N m", 5e-4)

EVERY = [
    FrictionNet(),
    FrictionNet(("speed", "load", "position", "time"), units=4, seed=3),
    FrictionNet(odd=False),
    FrictionNet(dissipative=False),
    FrictionNet(("speed", "load"), odd=False, dissipative=False),
    ResidualNet(("speed", "position"), units=5),
    MemoryNet(("speed",), units=3, memories=2),
]
every = pytest.mark.parametrize("net", EVERY, ids=lambda n: "-".join(map(str, n.options().values())))


def weights(net: Network, seed: int, size: float = 1.0) -> dict[str, float]:
    """Weights of any size, those that the bounds forbid among them; what scales the inputs is as the net declares it."""
    rng = np.random.default_rng(seed)
    declared = net.parameters(AROUND)
    return {p.name: p.value if p.fixed or p.name == "v_0" else size * rng.normal() for p in declared}


def force(net: Network, values: dict[str, float], **signals: Any) -> np.ndarray:
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in values.items()})
    s = Signals("signal", {n: torch.as_tensor(np.asarray(v, dtype=float)) for n, v in signals.items()})
    z = Signals("memory", {state.name: torch.tensor(0.3, dtype=torch.float64) for state in net.states(AROUND)})
    return np.asarray(net.force(s, p, z))


SPEEDS = np.linspace(-60.0, 60.0, 241)


@given(
    seed=st.integers(0, 10**6),
    size=st.floats(1e-3, 1e3),
    load=st.floats(-50, 50),
    position=st.floats(-30, 30),
    time=st.floats(0, 100),
    odd=st.booleans(),
)
def test_dissipative_friction_never_drives(
    seed: int, size: float, load: float, position: float, time: float, odd: bool
) -> None:
    """The power of the force on the body is not positive, for any weights whatever, bounds or not, within the range seen and beyond."""
    net = FrictionNet(("speed", "load", "position", "time"), units=3, odd=odd)
    found = force(net, weights(net, seed, size), speed=SPEEDS, load=load, position=position, time=time)
    assert (found * SPEEDS <= 0.0).all()


def test_dissipative_friction_is_there() -> None:
    net = FrictionNet(units=4)
    found = force(net, {**weights(net, 0), **{f"out_{k}": 1.0 for k in range(4)}}, speed=np.array([-5.0, 5.0]))
    assert found[0] > 1e-3 and found[1] < -1e-3


@given(seed=st.integers(0, 10**6), load=st.floats(-50, 50), dissipative=st.booleans())
def test_odd_friction_changes_its_sign_with_the_speed(seed: int, load: float, dissipative: bool) -> None:
    net = FrictionNet(("speed", "load"), units=3, dissipative=dissipative)
    values = weights(net, seed)
    forward, back = force(net, values, speed=SPEEDS, load=load), force(net, values, speed=-SPEEDS, load=-load)
    np.testing.assert_allclose(forward, -back, atol=1e-12)


def test_friction_that_need_not_be_odd() -> None:
    net = FrictionNet(odd=False, dissipative=False)
    values = weights(net, 1)
    assert np.abs(force(net, values, speed=SPEEDS) + force(net, values, speed=-SPEEDS)).max() > 0.1


@every
def test_zero_to_begin_with(net: Network) -> None:
    values = {p.name: p.value for p in net.parameters(AROUND)}
    rng = np.random.default_rng(0)
    signals = {name: rng.uniform(RANGES[name].low, RANGES[name].high, 50) for name in net.inputs}
    assert (force(net, values, **signals) == 0.0).all()
    assert any(p.shrunk for p in net.parameters(AROUND)), "the weights of the output are held towards zero"


@every
def test_hidden_weights_are_drawn_with_the_seed(net: Network) -> None:
    same, other = (type(net)(**{**net.options(), "seed": seed}) for seed in (net.seed, net.seed + 1))
    assert net.parameters(AROUND) == same.parameters(AROUND) != other.parameters(AROUND)


@pytest.mark.parametrize("net", [FrictionNet(units=12), ResidualNet(units=12)])
def test_any_curve_can_be_drawn(net: Network) -> None:
    """With the hidden weights as drawn, heights alone come within 10 % of a curve with a bump, over the whole range."""
    values = {p.name: p.value for p in net.parameters(AROUND)}
    speeds = np.linspace(-24.0, 24.0, 200)
    target = -np.tanh(speeds / 0.75) * (0.5 + np.exp(-0.5 * ((np.abs(speeds) - 14.0) / 3.0) ** 2))
    columns = np.stack([force(net, {**values, f"out_{k}": 1.0}, speed=speeds) for k in range(12)], axis=1)
    from scipy.optimize import nnls

    heights = nnls(columns, target)[0] if isinstance(net, FrictionNet) else np.linalg.lstsq(columns, target)[0]
    limit = 0.1 if isinstance(net, FrictionNet) else 0.3
    assert np.sqrt(np.mean((columns @ heights - target) ** 2)) < limit * np.sqrt(np.mean(target**2))


def arm_records(samples: int = 60) -> Records:
    t = 5e-4 * np.arange(samples)
    torque = 5.0 * np.sin(40.0 * t) + np.sin(2 * np.pi * 19 * t)
    dt, ends = np.full(samples, 5e-4), (np.array([0]), np.array([samples - 1]))
    return Records(torque[None], np.zeros((1, samples)), dt, *ends, ("",), "zoh")


@pytest.mark.parametrize(
    "net",
    [
        FrictionNet(("speed", "input@sun"), units=2),
        FrictionNet(("speed", "input@sun"), units=2, dissipative=False),
        ResidualNet(("speed", "input@sun"), units=2),
        MemoryNet(("speed", "input@sun"), units=2, memories=2),
    ],
)
def test_parameters_over_signals_from_elsewhere_have_names_of_their_own(net: Network) -> None:
    """Seen: "input@sun_0" beside "input_sun_centre"."""
    around = replace(AROUND, ranges={**RANGES, "input@sun": Range(0.0, 800.0, 300.0)})
    names = [p.name for p in net.parameters(around)]
    assert "input_sun_centre" in names and not [name for name in names if "@" in name]
    values = {p.name: p.value + 0.1 for p in net.parameters(around)}
    dark, bright = (force(net, values, **{"speed": 3.0, "input@sun": sun}) for sun in (0.0, 800.0))
    assert np.isfinite(dark) and dark != bright


PLACES = [
    ("motor", FrictionNet(("speed", "load"), units=3)),
    ("gearbox", FrictionNet(units=3, dissipative=False)),
    ("motor", ResidualNet(("speed", "load", "position", "time"), units=3)),
    ("gear_spring", ResidualNet(("deflection", "rate", "speed"), units=3)),
    ("actuator", ResidualNet(("input", "speed", "time"), units=3)),
    ("sensor", ResidualNet(("output",), units=3)),
]


def hybrid(port: str, net: Network) -> AugmentedModel:
    arm = RobotArm()
    return AugmentedModel(arm, [attach(arm, port, net)], {q.name: AROUND for q in arm.all_ports})


def started(model: AugmentedModel) -> np.ndarray:
    x0 = np.zeros((1, len(model.states)))
    x0[0, :5] = [0.02, -0.01, 15.0, 14.0, 16.0]
    return x0


@pytest.mark.parametrize(("port", "net"), PLACES)
def test_the_hybrid_begins_as_the_physics(port: str, net: Network) -> None:
    model, records = hybrid(port, net), arm_records()
    windows = Windows(np.array([0]), np.array([59]), 60)
    own, plain = (
        make_stepper(m, ()).run(records, Pass(windows, np.array(list(m.values().values())), x0)).y
        for m, x0 in ((model, started(model)), (RobotArm(), started(model)[:, :5]))
    )
    np.testing.assert_array_equal(own, plain)


@pytest.mark.parametrize(("port", "net"), PLACES)
def test_every_route_gives_the_same(port: str, net: Network) -> None:
    """Compiled, eager and torchdiffeq's, with weights that make a difference; tangents compiled and eager."""
    model, records = hybrid(port, net), arm_records(20)
    rng = np.random.default_rng(4)
    numbers = {n: v + 0.3 * rng.uniform() * n.split(".")[-1].startswith("out_") for n, v in model.values().items()}
    model.set_values(numbers)
    p, windows, x0 = np.array(list(numbers.values())), Windows(np.array([0]), np.array([19]), 20), started(model)
    free = tuple(q.name for q in model.declared_parameters if not q.fixed and q.name.startswith(port))
    native = make_stepper(model, free)
    assert isinstance(native, NativeStepper)
    compiled = native.run(records, Pass(windows, p, x0, tangents=True))
    eager = EagerStepper.of(model, free, "cpu", "double").run(records, Pass(windows, p, x0, tangents=True))
    np.testing.assert_allclose(compiled.y, eager.y, rtol=1e-12, atol=1e-12)
    assert compiled.dy is not None and eager.dy is not None
    np.testing.assert_allclose(compiled.dy, eager.dy, rtol=1e-7, atol=1e-12)
    assert np.abs(compiled.dy).max() > 0
    with torch.no_grad():
        other = solve(model, records, windows, torch.as_tensor(x0.T.copy())).numpy()
    np.testing.assert_allclose(compiled.y[0].T, other[:, :, 0], rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize(("port", "net"), PLACES)
def test_restored_from_json(port: str, net: Network) -> None:
    model = hybrid(port, net)
    entries = json.loads(json.dumps([attachment_json(a, AROUND) for a in model.attachments]))
    again = restored_model(RobotArm(), entries)
    assert again.declared_parameters == model.declared_parameters
    assert again.attachments[0].mechanism.options() == net.options()


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda: ResidualNet(()), "expected one signal or more"),
        (lambda: ResidualNet(("speed", "speed")), "each once"),
        (lambda: ResidualNet(units=0), "units is 0; expected a whole number from 1"),
        (lambda: ResidualNet(units=2.5), "units is 2.5"),  # type: ignore[arg-type]
        (lambda: FrictionNet(("load",)), "expected the speed among them"),
        (lambda: ResidualNet(("level",)).parameters(AROUND), "no signal 'level' at this port"),
    ],
)
def test_what_is_not_a_network(make: Any, expected: str) -> None:
    with pytest.raises(UserError, match=expected):
        make()
