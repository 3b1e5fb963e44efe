"""A model that asks for more steps is simulated with them, whatever the options say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import DEFAULT, SimulationOptions, Simulator
from greybox_torch.simulation.windows import Windows


class Block(GreyBoxModel):
    states = [State("speed", "m/s")]
    inputs = [Input("force", "N")]
    outputs = [Output("speed", "m/s")]
    parameters = [Parameter("m", 0.05, unit="kg", lower=0.0)]
    ports = [Body("block", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (u.force + port.block) / p.m}

    def output(self, x, u, p):
        return {"speed": x.speed}


MASS, FORCE, LEVEL, WIDTH, STEP = 0.05, 1.0, 2.0, 1e-3, 2e-3


def final_speed(substeps: int, options: SimulationOptions = DEFAULT) -> tuple[float, int]:
    """Where the speed of a block that friction holds comes to, and with how many steps per sample it was simulated."""
    block = Block()
    around = Surroundings({"speed": Range(-1.0, 1.0, 0.5)}, {"speed": "m/s"}, "N", STEP)
    held = replace(attach(block, "block", CoulombFriction()), substeps=substeps)
    model = AugmentedModel(block, [held], {"block": around})
    simulator = Simulator.of(model, (), options)
    count = 200
    records = Records(
        np.full((1, count), FORCE),
        np.zeros((1, count)),
        np.full(count, STEP),
        np.array([0]),
        np.array([count - 1]),
        ("",),
        "zoh",
    )
    names = [p.name for p in model.declared_parameters]
    p = np.array(
        [{"m": MASS, "block.coulomb_friction.F_c": LEVEL, "block.coulomb_friction.v_0": WIDTH}[n] for n in names]
    )
    run = simulator.run(records, Pass(Windows(records.first, records.last, count), p, np.array([[0.0]])))
    return float(run.y[0, -1, 0]), simulator.substeps


def test_friction_holds_a_light_block_only_in_fine_steps() -> None:
    """F_c tanh(v / v_0) = F: the analytic speed of creeping. One Runge-Kutta step per sample is 80 times too long for it."""
    creeping = WIDTH * np.arctanh(FORCE / LEVEL)
    coarse, steps = final_speed(1)
    assert steps == 1 and abs(coarse - creeping) > 3.0 * creeping
    fine, steps = final_speed(64)
    assert steps == 64 and fine == pytest.approx(creeping, rel=1e-9)


@pytest.mark.parametrize(("of_the_model", "of_the_options", "made"), [(4, 1, 4), (4, 8, 8), (1, 2, 2)])
def test_the_larger_number_counts(of_the_model: int, of_the_options: int, made: int) -> None:
    assert final_speed(of_the_model, SimulationOptions(substeps=of_the_options))[1] == made
