"""A pendulum on a driven joint, in MuJoCo; its angle and its speed are measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue import engine as known
from experiments.concealed.engine.describe import GRAVITY, Changes, document, inertial, joint, motors, slack_spring
from experiments.concealed.machines.base import Array, Channel
from experiments.concealed.machines.engine import EngineMachine

AT = "pivot"
EFFECTS = (
    known.dry("hinge", AT, (0.06, 0.12)),
    known.stop("hinge", AT, 1.2),
    known.drag(AT, (2.0, 4.0)),
    # Divided by a gain, the equation has other values of what is free, and another weight.
    *known.drives("actuator", gain=True, gain_twins=(("pivot", "gravity"),)),
    known.tilted((0.03, 0.06), 0, ((AT, "gravity"), ("sensor.angle", "sensor_bias")), ((AT, "constant_bias"),)),
    known.slack_spring("hinge", AT, (0.3, 0.6), (0.3, 0.5)),
)


class EnginePendulum(EngineMachine):
    """J d²θ/dt² = τ - mgl sin θ - d dθ/dt; the weight and its lever are known."""

    name = "engine_pendulum"
    title = "Pendulum on a motor"
    model = "model.py:DrivenPendulum"
    model_file = Path(__file__).parents[1] / "nominal" / "engine_pendulum.py"
    inputs = (Channel("torque", "torque", "N m"),)
    outputs = (Channel("angle", "angle", "rad"), Channel("speed", "speed", "rad/s"))
    parameters = ("J", "mgl", "d")
    known = ("mgl",)
    state_steps = (1e-4, 1e-3)
    catalogue = {effect.name: effect for effect in EFFECTS}

    joints, driven, followed, output_rows = ("hinge",), (0,), (0,), (0, 1)
    sensor_noise, resolution = (5e-4, 0.01), (0.0, 0.0)
    shaking, band, travel, gains = (0.8,), (0.5, 10.0), (1.2,), ((5.0, 0.5),)
    torque_noise, drift = 0.002, 0.0003

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        mass, length, damping = (x * float(np.exp(rng.uniform(-0.22, 0.22))) for x in (0.6, 0.42, 0.03))
        rod = 0.1 * mass * length**2
        weight = float(f"{mass * GRAVITY * length:.5g}")
        return {"J": mass * length**2 + rod, "mgl": weight, "d": damping, "length": length, "rod": rod}

    def description(self, truth: Mapping[str, float], changes: Changes, step: float) -> str:
        mass = truth["mgl"] / (GRAVITY * truth["length"])
        rod = truth["J"] - mass * truth["length"] ** 2
        hinge = joint("hinge", "hinge", "0 -1 0", changes, damping=truth["d"])
        weight = inertial(mass, f"0 0 {-truth['length']:.12g}", (rod, rod, 0.2 * rod))
        rest = motors(self.joints, changes) + slack_spring("hinge", changes)
        return document(f"<body>{hinge}{weight}</body>", rest, changes, step=step)

    def accelerations(self, p: Mapping[str, Array], q: Array, v: Array, u: Array) -> Array:
        return (u - p["mgl"] * np.sin(q) - p["d"] * v) / p["J"]
