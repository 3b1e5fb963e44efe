"""A two-link arm in the plane, in MuJoCo, a motor at each joint; the angles are measured, no speed is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue import engine as known
from experiments.concealed.engine.describe import Changes, document, inertial, joint, motors, slack_spring
from experiments.concealed.machines.base import Array, Channel
from experiments.concealed.machines.engine import EngineMachine

S, E = "shoulder", "elbow"
TURNED = ((S, "gravity"), (E, "gravity"))
EFFECTS = (
    known.dry(S, S, (0.3, 0.6)),
    known.dry(E, E, (0.08, 0.15)),
    known.stop(S, S, 0.8),
    *known.drives("actuator.shoulder_torque", gain=False),
    known.tilted((0.02, 0.04), 1, TURNED, ((S, "torque_ripple"), (S, "unknown"), (S, "constant_bias"), (E, "unknown"))),
    known.slack_spring(E, E, (0.8, 1.6), (0.2, 0.35)),
)


class EngineTwoLink(EngineMachine):
    """The planar arm with inertias a + 2 b cos q2, d + b cos q2, d, and viscous friction at both joints; the plane is level."""

    name = "engine_two_link"
    title = "Two-link arm"
    model = "model.py:PlanarArm"
    model_file = Path(__file__).parents[1] / "nominal" / "engine_two_link.py"
    inputs = (Channel("shoulder_torque", "torque1", "N m"), Channel("elbow_torque", "torque2", "N m"))
    outputs = (Channel("shoulder_angle", "angle1", "rad"), Channel("elbow_angle", "angle2", "rad"))
    parameters = ("a", "b", "d", "f1", "f2")
    known = ()
    state_steps = (1e-4, 1e-4, 1e-3, 1e-3)
    catalogue = {effect.name: effect for effect in EFFECTS}

    joints, driven, followed, output_rows = (S, E), (0, 1), (0, 1), (0, 1)
    sensor_noise, resolution = (2e-4, 2e-4), (0.0, 0.0)
    shaking, band, travel, gains = (3.0, 0.7), (0.5, 8.0), (0.8, 0.9), ((50.0, 9.0), (9.0, 1.2))
    torque_noise, drift = 0.001, 0.0001

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        m1, m2, length, f1, f2 = (x * float(np.exp(rng.uniform(-0.22, 0.22))) for x in (3.0, 1.5, 0.35, 0.5, 0.15))
        com1, com2 = 0.5 * length, 0.17
        about1, about2 = 0.1 * m1 * length**2, 0.35 * m2 * com2**2
        truth = {"d": about2 + m2 * com2**2, "b": m2 * length * com2, "f1": f1, "f2": f2}
        truth["a"] = about1 + m1 * com1**2 + m2 * length**2 + truth["d"]
        return truth | {"m1": m1, "m2": m2, "length": length}

    def description(self, truth: Mapping[str, float], changes: Changes, step: float) -> str:
        length, com1 = truth["length"], 0.5 * truth["length"]
        com2 = truth["b"] / (truth["m2"] * length)
        about2 = truth["d"] - truth["m2"] * com2**2
        about1 = truth["a"] - truth["d"] - truth["m1"] * com1**2 - truth["m2"] * length**2
        shoulder = joint(S, "hinge", "0 0 1", changes, damping=truth["f1"])
        elbow = joint(E, "hinge", "0 0 1", changes, damping=truth["f2"])
        upper = inertial(truth["m1"], f"{com1:.12g} 0 0", (0.6 * about1, 0.6 * about1, about1))
        lower = inertial(truth["m2"], f"{com2:.12g} 0 0", (0.6 * about2, 0.6 * about2, about2))
        arm = f'<body>{shoulder}{upper}<body pos="{length:.12g} 0 0">{elbow}{lower}</body></body>'
        return document(arm, motors(self.joints, changes) + slack_spring(E, changes), changes, step=step)

    def accelerations(self, p: Mapping[str, Array], q: Array, v: Array, u: Array) -> Array:
        cosine, sine = p["b"] * np.cos(q[1]), p["b"] * np.sin(q[1])
        whole, cross, outer = p["a"] + 2.0 * cosine, p["d"] + cosine, p["d"]
        first = u[0] - p["f1"] * v[0] + sine * (2.0 * v[0] * v[1] + v[1] ** 2)
        second = u[1] - p["f2"] * v[1] - sine * v[0] ** 2
        size = whole * outer - cross**2
        return np.stack([(outer * first - cross * second) / size, (whole * second - cross * first) / size])
