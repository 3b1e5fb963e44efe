"""Curves that multiply a port's own rate: inertias that vary with an angle or another axis, capacities that vary with a level."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp

from greybox_torch.diagnosis.describe.profiles import law_curve
from greybox_torch.diagnosis.describe.signal_names import as_named, signal_name
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction import ViscousFriction
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, Body, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.model.unit_of_rate import unit_of_integral, unit_of_rate
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records

TURN = 2 * np.pi


class Machine(GreyBoxModel):
    """A shaft, an arm that slides along it, and how warm they get."""

    states: ClassVar = [
        State(n, u) for n, u in (("angle", "rad"), ("omega", "rad/s"), ("place", "m"), ("slides", "m/s"), ("warm", "K"))
    ]
    inputs: ClassVar = [Input("torque", "N m")]
    outputs: ClassVar = [Output(s.name, s.unit) for s in states]
    parameters: ClassVar = [Parameter("J", 2.0, unit="kg m^2"), Parameter("C", 5.0, unit="J/K")]
    ports: ClassVar = [
        Body("shaft", speed="omega", position="angle"),
        Body("arm", speed="slides", position="place"),
        Balance("heat", level="warm"),
    ]

    def derivative(self, x, u, p, port):
        return {
            "angle": x.omega,
            "omega": (u.torque + port.shaft) / p.J,
            "place": x.slides,
            "slides": port.arm / 3.0,
            "warm": (u.torque**2 - x.warm + port.heat) / p.C,
        }

    def output(self, x, u, p):
        return dict(x)


def around(machine: Machine) -> dict[str, Surroundings]:
    """What every curve may need, over ranges that are given."""
    own = {"turn": Range(0.0, TURN, 3.6), "position": Range(-1.0, 1.0, 0.6), "speed": Range(-9.0, 9.0, 5.0)}
    ranges = {
        **own,
        "level": Range(0.0, 40.0, 20.0),
        "position@arm": Range(-1.0, 1.0, 0.6),
        "speed@arm": Range(-2.0, 2.0, 1.0),
        **{f"rate@{q.name}": Range(-3.0, 3.0, 1.0) for q in machine.ports},
    }
    return {q.name: Surroundings(ranges, {}, "N m", 0.01) for q in machine.all_ports}


def with_curve(
    port: str, curve: Unknown, shape, *others
) -> tuple[Machine, AugmentedModel, dict[str, float], np.ndarray]:
    """The machine with a curve whose heights draw ``shape`` over its signal, the heights by name, and their centres."""
    machine = Machine()
    attached = attach(machine, port, curve)
    augmented = AugmentedModel(machine, [attached, *others], around(machine))
    centres = np.array(curve.centres(around(machine)[port]))
    # bumps a spacing wide, a spacing apart, add up to sqrt(pi) where they are all alike
    values = {f"{attached.prefix}.w_{k}": float(shape(c)) / np.sqrt(np.pi) for k, c in enumerate(centres)}
    return machine, augmented, values, centres


def rates(model: GreyBoxModel, values: dict[str, float], **states: float) -> dict[str, float]:
    start = {"angle": 0.0, "omega": 0.0, "place": 0.0, "slides": 0.0, "warm": 0.0, **states}
    torque = start.pop("torque", 0.0)
    x = Signals("state", {n: torch.tensor(v, dtype=torch.float64) for n, v in start.items()})
    u = Signals("input", {"torque": torch.tensor(torque, dtype=torch.float64)})
    told = {q.name: q.value for q in model.declared_parameters} | values
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in told.items()})
    none = Signals("port", {q.name: torch.zeros((), dtype=torch.float64) for q in model.all_ports})
    return {n: float(v) for n, v in model.derivative(x, u, p, none).items()}


def test_the_slope_is_the_derivative_of_the_curve() -> None:
    for signal in ("turn", "position"):
        curve = Unknown(signal, 14, "rate@shaft")
        centres = curve.centres(around(Machine())["shaft"])
        own = {f"w_{k}": torch.tensor(np.sin(3.0 * k), dtype=torch.float64) for k in range(14)}
        own |= {"first": torch.tensor(centres[0]), "spacing": torch.tensor(centres[1] - centres[0])}
        p, end = Signals("parameter", own), TURN if signal == "turn" else 1.0
        s = torch.linspace(0.01 - (signal == "position"), end - 0.01, 97, dtype=torch.float64)
        above, below = (curve.curve(Signals("signal", {signal: s + h}), p) for h in (1e-6, -1e-6))
        slope = curve.slope(Signals("signal", {signal: s}), p)
        torch.testing.assert_close(slope, (above - below) / 2e-6, rtol=1e-6, atol=1e-6)


def test_a_curve_over_a_turn_ends_where_it_begins() -> None:
    _, model, values, _ = with_curve("shaft", Unknown("turn", 14, "rate@shaft"), np.cos)
    for angle in (0.0, 0.3, 3.0, 6.2):
        here, later, before = (
            rates(model, values, angle=angle + k * TURN, omega=4.0, torque=2.0)["omega"] for k in (0, 3, -2)
        )
        assert later == pytest.approx(here, rel=1e-9) and before == pytest.approx(here, rel=1e-9)
    just_before, just_after = (rates(model, values, angle=a, omega=4.0, torque=2.0)["omega"] for a in (-1e-7, 1e-7))
    assert just_before == pytest.approx(just_after, rel=1e-5)


def test_a_shaft_whose_inertia_varies_turns_as_lagrange_says() -> None:
    """J(θ) a + ½ J' ω² = τ by scipy, of which the model without the curve lacks a hundred times more than with it."""
    more = 0.02
    _, model, heights, centres = with_curve(
        "shaft", Unknown("turn", 14, "rate@shaft"), lambda c: -2.0 * more * np.cos(2 * c) * np.exp((2 * 0.449) ** 2 / 4)
    )
    assert centres[1] - centres[0] == pytest.approx(
        0.449, rel=1e-3
    )  # a wave through such bumps is smoothed by the factor above
    t = np.linspace(0.0, 3.0, 301)
    torque = np.sin(2.0 * t)

    def lagrange(now: float, x: np.ndarray) -> list[float]:
        inertia, slope = 2.0 * (1 + more * np.cos(2 * x[0])), -4.0 * more * np.sin(2 * x[0])
        return [x[1], (np.sin(2.0 * now) - 0.5 * slope * x[1] ** 2) / inertia]

    truth = solve_ivp(lagrange, (0.0, 3.0), [0.2, 6.0], t_eval=t, rtol=1e-10, atol=1e-12).y

    def missed(of: GreyBoxModel, values: dict[str, float]) -> float:
        def rhs(now: float, x: np.ndarray) -> list[float]:
            found = rates(of, values, angle=x[0], omega=x[1], torque=np.sin(2.0 * now))
            return [found["angle"], found["omega"]]

        y = solve_ivp(rhs, (0.0, 3.0), [0.2, 6.0], t_eval=t, rtol=1e-8, atol=1e-10).y
        return float(np.sqrt(np.mean((y[1] - truth[1]) ** 2)))

    assert torque.any() and missed(model, heights) < 0.05 * missed(Machine(), {})


def test_an_inertia_over_another_axis_gives_no_energy() -> None:
    """Without a torque ½ (J + m(x)) ω² + ½ 3 v² stays: its rate is that of the product of what varies, to first order of m / J."""
    _, model, values, _ = with_curve("shaft", Unknown("position@arm", 14, "rate@shaft"), lambda c: -0.01 * c)
    state = {"omega": 3.0, "slides": 0.7, "place": 0.2}
    found = rates(model, values, **state)
    slope = 0.01  # of m over the place
    power = 2.0 * found["omega"] * state["omega"] + 3.0 * found["slides"] * state["slides"]
    assert found["slides"] == pytest.approx(0.5 * slope * 9.0 / 3.0, rel=5e-3)
    assert power + 0.5 * slope * state["slides"] * state["omega"] ** 2 == pytest.approx(0.0, abs=5e-4)


def test_a_capacity_over_the_level_takes_its_share_of_the_heat() -> None:
    _, model, values, _ = with_curve("heat", Unknown("level", 14, "rate@heat"), lambda c: -0.1)
    plain, found = (rates(m, v, warm=20.0, torque=3.0)["warm"] for m, v in ((Machine(), {}), (model, values)))
    assert found == pytest.approx(plain * (1.0 - 0.1 / 5.0), rel=1e-3)


def test_the_rate_is_that_with_all_other_laws() -> None:
    friction = attach(Machine(), "shaft", ViscousFriction())
    _, model, values, _ = with_curve("shaft", Unknown("turn", 14, "rate@shaft"), lambda c: -0.1, friction)
    found = rates(model, values | {"shaft.viscous_friction.c": 0.5}, omega=4.0, torque=1.0)["omega"]
    assert found == pytest.approx((1.0 - 0.5 * 4.0) / 2.0 * (1.0 - 0.1 / 2.0), rel=1e-3)


def test_what_is_driven_from_one_look_does_not_change_another_one() -> None:
    """In a screen all candidates are attached at once, each with a share of its own."""
    machine = Machine()
    looks = [attach(machine, "shaft", ViscousFriction()), attach(machine, "shaft", Unknown("turn", 14, "rate@shaft"))]
    model = AugmentedModel(machine, looks, around(machine), probed=looks)
    values = {f"{a.prefix}.share": 1.0 for a in looks} | {"shaft.viscous_friction.c": 0.5}
    values |= {f"shaft.unknown.w_{k}": -0.1 / np.sqrt(np.pi) for k in range(14)}
    found = rates(model, values, omega=4.0, torque=1.0)["omega"]
    assert found == pytest.approx((1.0 - 0.5 * 4.0 - 0.1 * (1.0 / 2.0)) / 2.0, rel=1e-3)


def test_which_are_offered_and_how_they_are_called() -> None:
    machine = Machine()
    found = candidates(machine, {}, around(machine), flexible=True)
    by_rate = {(a.port, a.mechanism.signal) for a in found if a.mechanism.by_rate}
    assert {("shaft", "turn"), ("shaft", "position"), ("arm", "position"), ("heat", "level")} <= by_rate
    assert ("shaft", "position@arm") in by_rate
    assert signal_name(machine, machine.ports[0], "turn") == "angle within a turn"
    assert signal_name(machine, machine.ports[0], "rate@shaft") == "d omega/dt"
    assert (unit_of_rate("rad/s"), unit_of_rate("K"), unit_of_rate("")) == ("rad/s^2", "K/s", "")


def test_the_unit_of_a_position_is_that_of_the_integrated_speed() -> None:
    """Seen: the position of a body whose speed is in a tachometer's volts, in V."""
    units = {"rad/s": "rad", "m/s": "m", "V": "V s", "rpm": "rpm s", "rad/s^2": "rad/s", "1/s": "1", "-": "s", "": ""}
    units |= {"m/s²": "m/s", "m s^-1": "m", "rad s-1": "rad", "m s^-2": "m s^-1", "N m/s": "N m"}
    assert {unit: unit_of_integral(unit) for unit in units} == units


@pytest.mark.parametrize("signal", ["turn", "position", "position@arm"])
def test_compiled_code_agrees(signal: str) -> None:
    _, model, values, _ = with_curve("shaft", Unknown(signal, 8, "rate@shaft"), lambda c: 0.1 * np.sin(c))
    told = {q.name: q.value for q in model.declared_parameters} | values
    model.set_values(values)
    sensitive = ("J", "shaft.unknown.w_3")
    compiled, eager = make_stepper(model, sensitive), EagerStepper.of(model, sensitive, "cpu", "double")
    assert isinstance(compiled, NativeStepper)
    records = Records(
        np.full((1, 6), 1.5), np.zeros((5, 6)), np.full(6, 0.05), np.array([0]), np.array([5]), ("one",), "zoh"
    )
    start = np.array([[0.4, 5.0, 0.3, 0.8, 10.0]])
    asked = Pass(whole_records(records), np.array([*told.values()]), start, tangents=True)
    found, expected = compiled.run(records, asked), eager.run(records, asked)
    np.testing.assert_allclose(found.y, expected.y, rtol=1e-10)
    np.testing.assert_allclose(found.dy, expected.dy, rtol=1e-8, atol=1e-10)


def test_it_is_drawn_as_what_it_takes_of_the_rate() -> None:
    """Not with the force of the turning shaft, which is that of the slope."""
    _, model, values, _ = with_curve("shaft", Unknown("turn", 14, "rate@shaft"), lambda c: -0.1 * (1 + 0.3 * np.cos(c)))
    told = {q.name: q.value for q in model.declared_parameters} | values
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in told.items()})
    drawn = law_curve(model, model.attachments[0], around(Machine())["shaft"], SimpleNamespace(parameter_tensors=p))
    assert drawn is not None and drawn.force.shape == drawn.values.shape
    np.testing.assert_allclose(drawn.force, -0.1 * (1 + 0.3 * np.cos(drawn.values)), atol=0.01)
    named = as_named(drawn, Machine(), Machine.ports[0])
    assert named is not None and named.signal == "angle within a turn"
