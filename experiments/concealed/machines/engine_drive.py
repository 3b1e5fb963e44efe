"""A motor, a shaft and a load, in MuJoCo; encoders at both ends, no speed is measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue import engine as known
from experiments.concealed.engine.describe import Changes, document, inertial, joint, motors, spring
from experiments.concealed.machines.base import Array, Channel
from experiments.concealed.machines.engine import EngineMachine

EFFECTS = (
    known.dry("motor", "motor", (0.04, 0.08), behind=("load",)),
    known.dry("load", "load", (0.04, 0.08), behind=("motor",)),
    known.stop("motor", "motor", 3.0),
    known.dead_band("shaft", "shaft", (0.003, 0.006)),
    *known.drives("actuator", gain=True),
)


class EngineDrive(EngineMachine):
    """Jm dwm/dt = τ - T - dm wm, Jl dwl/dt = T - dl wl, T = k (qm - ql) + c (wm - wl); the motor's inertia is known."""

    name = "engine_drive"
    title = "Motor, shaft and load"
    model = "model.py:DriveTrain"
    model_file = Path(__file__).parents[1] / "nominal" / "engine_drive.py"
    inputs = (Channel("torque", "torque", "N m"),)
    outputs = (Channel("motor_angle", "motor", "rad"), Channel("load_angle", "load", "rad"))
    parameters = ("Jm", "Jl", "k", "c", "dm", "dl")
    known = ("Jm",)
    state_steps = (1e-4, 1e-4, 1e-2, 1e-2)
    catalogue = {effect.name: effect for effect in EFFECTS}

    joints, driven, followed, output_rows = ("motor", "load"), (0,), (0,), (0, 1)
    sensor_noise, resolution = (3e-4, 3e-4), (0.0, 0.0)
    shaking, band, travel, gains = (0.5,), (1.0, 20.0), (3.0,), ((3.0, 0.4),)
    torque_noise, drift = 0.0003, 0.00005

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        usual = {"Jm": 0.012, "Jl": 0.04, "k": 40.0, "c": 0.06, "dm": 0.02, "dl": 0.02}
        truth = {name: value * float(np.exp(rng.uniform(-0.22, 0.22))) for name, value in usual.items()}
        return truth | {"Jm": float(f"{truth['Jm']:.5g}")}

    def description(self, truth: Mapping[str, float], changes: Changes, step: float) -> str:
        bodies = ""
        for name, inertia, damping in (("motor", "Jm", "dm"), ("load", "Jl", "dl")):
            hinge = joint(name, "hinge", "0 0 1", changes, damping=truth[damping])
            bodies += f"<body>{hinge}{inertial(1.0, '0 0 0', (truth[inertia],) * 3)}</body>"
        gap = changes.get("shaft.gap", 0.0)
        shaft = spring("shaft", {"motor": 1.0, "load": -1.0}, stiffness=truth["k"], damping=truth["c"], band=gap)
        return document(bodies, motors(("motor",), changes) + shaft, changes, step=step)

    def accelerations(self, p: Mapping[str, Array], q: Array, v: Array, u: Array) -> Array:
        torque = p["k"] * (q[0] - q[1]) + p["c"] * (v[0] - v[1])
        return np.stack([(u[0] - torque - p["dm"] * v[0]) / p["Jm"], (torque - p["dl"] * v[1]) / p["Jl"]])
