"""What acts along a part of the way, or in proportion to something else as well: unknown, and at its place."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.systems.load import load_model


def dip(q: np.ndarray, at: float, width: float) -> np.ndarray:
    """The slope of a rail with a dip, as a share of the largest."""
    s = (q - at) / width
    return -s * np.exp(0.5 - 0.5 * s**2)


@pytest.mark.parametrize(
    "missing",
    [
        lambda q, v: 0.8 * dip(q, 0.12, 0.025) - 0.5 * dip(q, -0.2, 0.025),
        lambda q, v: -3.0 * v / (1 + np.exp((0.1 - q) / 0.02)),
    ],
    ids=["a dip and a bump of a rail", "a brake over a part of the way"],
)
def test_a_force_of_a_part_of_the_way_is_unknown_at_the_body(missing, sled_run, machines) -> None:
    """Seen: dips of a thirtieth of the way, told as nothing; an eddy-current brake, as something without a name."""
    data = sled_run(missing, noise=1e-4, roles=["estimation", "validation"])
    verdict = diagnose(data, load_model(f"{machines / 'sled.py'}:Sled")).verdict
    (effect,) = verdict.effects
    assert (effect.port, effect.mechanism) == ("sled", "unknown")
    assert verdict.left is None or verdict.left.share < 0.1


class Wing(GreyBoxModel):
    """A wing on a hinge, moved by a motor in a flow of measured pressure; its lift grows with its angle."""

    states = [State("angle", "rad", initial="measured"), State("w", "rad/s")]
    inputs = [Input("torque", "N m"), Input("pressure", "Pa")]
    outputs = [Output("angle", "rad")]
    parameters = [Parameter("J", 1.0, lower=0.01), Parameter("c", 1.0, lower=0.0), Parameter("lift", 0.01, lower=0.0)]
    ports = [Body("wing", speed="w", position="angle")]

    def derivative(self, x, u, p, port):
        torque = u.torque - p.c * x.w - p.lift * u.pressure * x.angle
        return {"angle": x.w, "w": (torque + port.wing) / p.J}

    def output(self, x, u, p):
        return {"angle": x.angle}


def test_what_grows_with_an_input_and_changes_along_the_way_is_told_at_the_body(data_set) -> None:
    """Seen: a wing that stalls, told as a gain of the measured pressure. Here the flow pushes a wing also where its angle is zero."""
    step, rng, runs = 2e-3, np.random.default_rng(0), []
    t = step * np.arange(4000)
    for e in range(3):
        waves = [(0.3, 2.1 + 0.3 * e, 0.4), (0.12, 5.3, 1.0 + e), (0.02, 11.7, 0.2)]
        q, v, a = (sum(size * w**k * np.sin(w * t + f + k * np.pi / 2) for size, w, f in waves) for k in range(3))
        pressure = 300.0 + 200.0 * np.sin((0.9 + 0.2 * e) * t)
        lift = 0.01 * pressure * (q + 0.2 * np.exp(-((q / 0.1) ** 2)))
        runs.append(
            {"torque": 2.5 * a + 0.8 * v + lift, "pressure": pressure, "angle": q + rng.normal(0, 1e-4, len(t))}
        )
    roles = ["estimation", "estimation", "validation"]
    data = data_set(
        {"torque": "N m", "pressure": "Pa", "angle": "rad"}, runs, sample_time=step, hold="foh", roles=roles
    )
    verdict = diagnose(data, Wing()).verdict
    (effect,) = verdict.effects
    assert (effect.port, effect.mechanism) == ("wing", "unknown")
    assert [p.signal for p in effect.profiles] == ["angle", "pressure"]
