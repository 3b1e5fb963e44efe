"""Outputs that are accelerations: forces at the ports reach them as they reach the rates."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model.shown_rates import shown_rates
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.simulation.windows import whole_records

AROUND = {"cart": Surroundings({"speed": Range(-1.0, 1.0, 0.5)}, {"speed": "m/s"}, "N", 0.01)}


class TwoMasses(GreyBoxModel):
    """A cart that pulls a load by a spring, seen by accelerometers and a load cell."""

    states = [State("stretch", "m"), State("v", "m/s"), State("w", "m/s")]
    inputs = [Input("force", "N"), Input("speed", "m/s")]
    outputs = [
        Output("cart_acc", "m/s^2"),
        Output("backwards", "m/s^2"),
        Output("middle", "m/s^2"),
        Output("on_a_road", "m/s^2"),
        Output("pull", "N"),
        Output("of_two_kilograms", "N"),
        Output("v", "m/s"),
    ]
    parameters = [Parameter("m", 3.0, unit="kg"), Parameter("k", 50.0, unit="N/m"), Parameter("d", 0.4, unit="N s/m")]
    ports = [
        Body("cart", speed="v"),
        Body("load", speed="w"),
        Coupling("spring", deflection="stretch", rate=lambda x, u, p: x.v - x.w),
    ]

    def pull(self, x, p, port=0.0):
        return p.k * x.stretch + p.d * (x.v - x.w) + port

    def derivative(self, x, u, p, port):
        pull = self.pull(x, p, port.spring)
        return {"stretch": x.v - x.w, "v": (u.force - pull + port.cart) / p.m, "w": (pull + port.load) / 2.0}

    def output(self, x, u, p):
        a, pull = (u.force - self.pull(x, p)) / p.m, self.pull(x, p)
        return {
            "cart_acc": a,
            "backwards": -a,
            "middle": 0.5 * a + 0.25 * pull,
            "on_a_road": a + u.speed * x.w,
            "pull": pull,
            "of_two_kilograms": pull,
            "v": x.v,
        }


class Asking(TwoMasses):
    """Hands the forces on itself."""

    def output(self, x, u, p, port):
        return super().output(x, u, p)


class WithoutUnits(TwoMasses):
    states = [State(s.name) for s in TwoMasses.states]
    outputs = [Output(o.name) for o in TwoMasses.outputs]


def test_which_outputs_show_rates_and_by_which_factors() -> None:
    """A load cell does not, though a force is a mass times an acceleration."""
    shown = shown_rates(TwoMasses())
    assert shown == {
        "cart_acc": {"v": pytest.approx(1.0)},
        "backwards": {"v": pytest.approx(-1.0)},
        "middle": {"v": pytest.approx(0.5), "w": pytest.approx(0.5)},
        "on_a_road": {"v": pytest.approx(1.0)},
    }
    assert TwoMasses().shows_forces


def test_a_model_that_hands_the_forces_on_itself_is_left_alone() -> None:
    assert shown_rates(Asking()) == {}


def test_without_units_only_a_rate_itself_is_taken_for_one() -> None:
    assert set(shown_rates(WithoutUnits())) == {"cart_acc", "backwards", "on_a_road"}


@pytest.fixture
def biased() -> AugmentedModel:
    model = TwoMasses()
    return AugmentedModel(
        model, [attach(model, "cart", ConstantBias())], AROUND, start={"cart.constant_bias.bias": 0.6}
    )


def test_a_missing_force_is_in_the_accelerations_and_nowhere_else(biased) -> None:
    x, u = torch.randn(3, 9, dtype=torch.float64), torch.randn(2, 9, dtype=torch.float64)
    with torch.no_grad():
        plain, there = (m.measured(x, u, m.physical()).numpy() for m in (TwoMasses(), biased))
    per_mass = 0.6 / 3.0
    expected = np.array([per_mass, -per_mass, 0.5 * per_mass, per_mass, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(there - plain, np.repeat(expected[:, None], 9, axis=1), atol=1e-12)


def test_the_compiled_stepper_shows_it_too(biased) -> None:
    """Against the derivative of a simulated speed."""
    count, step = 400, 1e-3
    u = np.stack([np.full(count, 2.0), np.zeros(count)])
    ends = np.array([0]), np.array([count - 1])
    records = Records(u, np.zeros((7, count)), np.full(count, step), *ends, ("",), "zoh")
    values = np.array(list(biased.values().values()))
    simulator = Simulator.of(biased, (), SimulationOptions())
    run = simulator.run(records, Pass(whole_records(records), values, np.array([[0.01, 0.2, -0.1]])))
    acceleration, speed = run.y[0, :, 0], run.y[0, :, -1]
    np.testing.assert_allclose(acceleration[1:-1], (speed[2:] - speed[:-2]) / (2 * step), atol=1e-4)
