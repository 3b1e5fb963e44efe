"""The driven pendulum, its angle and its speed measured. Parameters redrawn about a desktop pendulum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue import one_body, one_body_friction, one_body_outside
from experiments.concealed.effects import Effect, Surroundings, Switches
from experiments.concealed.laws import body, drive
from experiments.concealed.machines.base import Array, Channel
from experiments.concealed.machines.one_body import OneBody

USUAL = one_body_friction.Usual("pivot", force=2.0, speed=6.0, travel=1.5, bristle=0.02)
SPEED = "sensor.speed"


def _catalogue() -> dict[str, Effect]:
    u = USUAL
    right = (
        (("actuator", "input_delay"),),
        ((SPEED, "output_delay"),),
        (("actuator", "input_lag"),),
        ((SPEED, "sensor_lag"),),
    )
    found = [
        *one_body_friction.frictions(u),
        *one_body.forces(u),
        *one_body_friction.richer(u),
        one_body.ripple(u, 3.0, 20.0),
        *one_body.drives(u),
        *one_body.timings(SPEED, 0.03, right[:2], right[2:]),
        # Divided by a gain, the equation has other values of what is free, and another weight.
        *one_body.gains(SPEED, ((("actuator", "input_gain"),), ((SPEED, "sensor_gain"),)), (("pivot", "gravity"),)),
        *_of_the_pendulum(),
        *one_body_outside.outside(u),
    ]
    return {effect.name: effect for effect in found}


def _of_the_pendulum() -> list[Effect]:
    def load(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"c": s * g.uniform(0.03, 0.06), "v_0": 0.02}

    def gravity(g: Generator, s: float, c: Surroundings) -> Switches:
        # at most 60 degrees off the rod: across it, a small weight is the same as an angle sensor that is turned a little
        angle = float(g.choice([0.0, np.pi])) + g.uniform(-1.05, 1.05)
        return {"moment": s * g.uniform(0.1, 0.2), "angle": angle}

    def bias(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"bias": min(s * g.uniform(0.1, 0.3), 1.0) * float(g.choice([-1.0, 1.0]))}

    return [
        Effect(
            name="load_friction",
            law=body.LoadDependentFriction,
            port="pivot",
            family="friction",
            draw=load,
            accept=(("pivot", "load_dependent_friction"),),
            near=(("pivot", "coulomb_friction"), ("pivot", "stribeck_friction")),
            ports=("pivot",),
        ),
        Effect(
            name="gravity",
            law=body.Gravity,
            port="pivot",
            family="position",
            draw=gravity,
            accept=(("pivot", "gravity"),),
            near=(("sensor.angle", "sensor_bias"),),
            ports=("pivot",),
        ),
        Effect(
            name="sensor_bias",
            law=drive.SensorBias,
            port=SPEED,
            family="bias",
            draw=bias,
            accept=((SPEED, "sensor_bias"),),
            ports=(SPEED,),
        ),
    ]


class Pendulum(OneBody):
    """I d²θ/dt² = τ - b dθ/dt - m g l sin θ; the weight and its lever are known, the inertia is not."""

    name = "pendulum"
    title = "Pendulum"
    model = "model.py:Pendulum"
    model_file = Path(__file__).parents[1] / "nominal" / "pendulum.py"
    inputs = (Channel("torque", "torque", "N m"),)
    outputs = (Channel("angle", "angle", "rad"), Channel("speed", "speed", "rad/s"))
    sample_time = 0.002
    samples = 4000
    parameters = ("I", "mgl", "b")
    known = ("mgl",)
    state_steps = (1e-4, 1e-3)
    catalogue = _catalogue()

    body = "pivot"
    sensors = ("sensor.angle", SPEED)
    output_rows = (0, 1)
    sensor_noise = (1e-3, 0.02)
    resolution = (2.0 * np.pi / 2**16, 5e-3)
    shaking, band = 0.8, (0.5, 10.0)
    move, sweep = 1.2, 1.2
    torque_noise, drift = 0.004, 0.0005

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        inertia, weight, damping = (value * float(np.exp(rng.uniform(-0.22, 0.22))) for value in (0.15, 2.7, 0.05))
        return {"I": inertia, "mgl": float(f"{weight:.5g}"), "b": damping, "inertia": inertia}

    def physics(self, parameters: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        return parameters["I"], parameters["b"], parameters["mgl"]

    def gains(self, rng: Generator) -> tuple[float, float]:
        return float(rng.uniform(5.0, 8.0)), float(rng.uniform(0.4, 0.7))
