"""The positioning stage: a carriage on a rail, its position measured. Parameters redrawn about a small laboratory stage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue import one_body, one_body_friction, one_body_outside
from experiments.concealed.effects import Effect
from experiments.concealed.machines.base import Array, Channel
from experiments.concealed.machines.one_body import OneBody

USUAL = one_body_friction.Usual("carriage", force=40.0, speed=0.4, travel=0.12, bristle=2e-4)
DELAY = (("actuator", "input_delay"), ("sensor", "output_delay"))
LAG = (("actuator", "input_lag"), ("sensor", "sensor_lag"))
GAIN = (("actuator", "input_gain"), ("sensor", "sensor_gain"))


def _catalogue() -> dict[str, Effect]:
    u = USUAL
    found = [
        *one_body_friction.frictions(u),
        *one_body.forces(u),
        *one_body_friction.richer(u),
        one_body.ripple(u, 2.0 * np.pi / 0.03, 2.0 * np.pi / 0.01),
        *one_body.drives(u),
        *one_body.timings("sensor", 0.015, (DELAY, DELAY), (LAG, LAG)),
        *one_body.gains("sensor", (GAIN, GAIN)),
        *one_body_outside.outside(u),
    ]
    return {effect.name: effect for effect in found}


class Stage(OneBody):
    """M d²x/dt² = F - F_v dx/dt; the mass is known (it was weighed)."""

    name = "stage"
    title = "Positioning stage"
    model = "model.py:PositioningStage"
    model_file = Path(__file__).parents[1] / "nominal" / "positioning_stage.py"
    inputs = (Channel("force", "force", "N"),)
    outputs = (Channel("position", "position", "m"),)
    sample_time = 0.001
    samples = 4000
    parameters = ("M", "F_v")
    known = ("M",)
    catalogue = _catalogue()

    body = "carriage"
    sensors = ("sensor",)
    output_rows = (0,)
    sensor_noise = (2e-5,)
    resolution = (5e-6,)
    shaking, band = 25.0, (1.0, 15.0)
    move, sweep = 0.1, 0.08
    torque_noise, drift = 0.03, 0.003

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        mass, damping = 20.0 * np.exp(rng.uniform(-0.22, 0.22)), 60.0 * np.exp(rng.uniform(-0.22, 0.22))
        return {"M": float(f"{mass:.5g}"), "F_v": float(damping), "inertia": float(mass)}

    def physics(self, parameters: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        return parameters["M"], parameters["F_v"], np.zeros_like(parameters["M"])

    def gains(self, rng: Generator) -> tuple[float, float]:
        return float(rng.uniform(2500.0, 3500.0)), float(rng.uniform(250.0, 350.0))
