"""A cart with a hanging pole, in MuJoCo; position and angle are measured, no speed is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue import engine as known
from experiments.concealed.engine.describe import GRAVITY, Changes, document, inertial, joint, motors, slack_spring
from experiments.concealed.machines.base import Array, Channel
from experiments.concealed.machines.engine import EngineMachine

EFFECTS = (
    known.dry("slide", "cart", (0.4, 0.8)),
    known.dry("hinge", "pole", (0.006, 0.012)),
    known.damping("hinge", "pole", (0.002, 0.004)),
    known.stop("slide", "cart", 0.25),
    *known.drives("actuator", gain=True),
    known.slack_spring("slide", "cart", (15.0, 30.0), (0.05, 0.1)),
)


class EngineCart(EngineMachine):
    """m d²x/dt² + s (θ'' cos θ - θ'² sin θ) = F - f x', s x'' cos θ + J θ'' + s g sin θ = 0; the whole mass m is known."""

    name = "engine_cart"
    title = "Cart with a hanging pole"
    model = "model.py:CartWithPole"
    model_file = Path(__file__).parents[1] / "nominal" / "engine_cart.py"
    inputs = (Channel("force", "force", "N"),)
    outputs = (Channel("position", "position", "m"), Channel("angle", "angle", "rad"))
    parameters = ("m", "s", "J", "f")
    known = ("m",)
    state_steps = (1e-4, 1e-4, 1e-3, 1e-3)
    catalogue = {effect.name: effect for effect in EFFECTS}

    joints, driven, followed, output_rows = ("slide", "hinge"), (0,), (0,), (0, 1)
    sensor_noise, resolution = (5e-5, 3e-4), (0.0, 0.0)
    shaking, band, travel, gains = (1.5,), (0.5, 6.0), (0.25,), ((25.0, 7.0),)
    corner = 0.15
    torque_noise, drift = 0.002, 0.0002

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        cart, pole, length, damping = (x * float(np.exp(rng.uniform(-0.22, 0.22))) for x in (1.0, 0.25, 0.3, 2.0))
        whole = float(f"{cart + pole:.5g}")
        return {"m": whole, "s": pole * length, "J": 1.3 * pole * length**2, "f": damping, "pole": pole}

    def description(self, truth: Mapping[str, float], changes: Changes, step: float) -> str:
        length = truth["s"] / truth["pole"]
        about = truth["J"] - truth["s"] * length
        slide = joint("slide", "slide", "1 0 0", changes, damping=truth["f"])
        hinge = joint("hinge", "hinge", "0 -1 0", changes, damping=0.0)
        pole = inertial(truth["pole"], f"0 0 {-length:.12g}", (about, about, 0.2 * about))
        cart = inertial(truth["m"] - truth["pole"], "0 0 0", (0.01, 0.01, 0.01))
        rest = motors(("slide",), changes) + slack_spring("slide", changes)
        return document(f"<body>{slide}{cart}<body>{hinge}{pole}</body></body>", rest, changes, step=step)

    def accelerations(self, p: Mapping[str, Array], q: Array, v: Array, u: Array) -> Array:
        cross, sine = p["s"] * np.cos(q[1]), p["s"] * np.sin(q[1])
        along = u[0] - p["f"] * v[0] + sine * v[1] ** 2
        about = -GRAVITY * sine
        whole = p["m"] * p["J"] - cross**2
        return np.stack([(p["J"] * along - cross * about) / whole, (p["m"] * about - cross * along) / whole])
