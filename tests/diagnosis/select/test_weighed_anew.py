"""What an exact sensor shows, and a far noisier one beside it hides once what was missing is found."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest

import greybox_torch as gt

STEP, FINE, FRICTION = 0.01, 100, 4.0
"""s, parts of a step, N"""


class Carriage(gt.GreyBoxModel):
    """A mass that a force moves; its friction is left out."""

    states: ClassVar = [gt.State("position", "m"), gt.State("speed", "m/s")]
    inputs: ClassVar = [gt.Input("force", "N")]
    outputs: ClassVar = [gt.Output("speed", "m/s"), gt.Output("position", "m")]
    parameters: ClassVar = [
        gt.Parameter("m", 2.0, unit="kg", lower=0.1),
        gt.Parameter("b", 1.0, unit="N s/m", lower=0.0),
    ]
    ports: ClassVar = [gt.Body("carriage", speed="speed", position="position")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"position": x.speed, "speed": (u.force - p.b * x.speed + port.carriage) / p.m}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed, "position": x.position}


def recorded(late: int, name: str, seed: int) -> gt.Recording:
    """A thousand samples, the speed's sensor with 0.1 m/s of noise, the position's with 5 µm and ``late`` parts of a step behind."""
    rng, count = np.random.default_rng(seed), 1000
    force = np.repeat(rng.uniform(-8.0, 8.0, count // 40), 40)
    x, v, rows = 0.0, 0.0, []
    for f in force:
        for _ in range(FINE):
            rows.append((x, v))
            a = (f - 1.0 * v - FRICTION * np.tanh(v / 0.01)) / 2.0
            v += STEP / FINE * a
            x += STEP / FINE * v
    position, speed = np.array(rows).T
    at = FINE * np.arange(count)
    signals = {
        "force": force,
        "speed": speed[at] + 0.1 * rng.standard_normal(count),
        "position": position[np.maximum(at - late, 0)] + 5e-6 * rng.standard_normal(count),
    }
    role = "validation" if name == "C" else "estimation"
    units = {"force": "N", "speed": "m/s", "position": "m"}
    return gt.Recording.from_arrays(name, signals, sample_time=STEP, role=role, units=units)


@pytest.mark.parametrize("late", [0, 60])
def test_a_late_exact_sensor_is_told_beside_what_is_missing(late: int) -> None:
    """Seen: an encoder 3 ms late, 150 times its noise, beside a dry friction, told as friction alone."""
    data = gt.DataSet([recorded(late, name, k) for k, name in enumerate("ABC")])
    verdict = gt.diagnose(Carriage(), data).verdict
    (friction,) = verdict.effects
    assert (friction.port, friction.mechanism) == ("carriage", "coulomb_friction")
    assert friction.parameters["F_c"]["value"] == pytest.approx(FRICTION, rel=0.01)
    assert any("times its own in position: the search was made once more" in line for line in verdict.evidence)
    found = {e.port: e for e in verdict.refinements}
    assert set(found) == ({"sensor.position"} if late else set())
    if late:
        assert found["sensor.position"].parameters["T"]["value"] == pytest.approx(late / FINE * STEP, rel=0.05)
        assert "at sensor.position (T = 0.005" in found["sensor.position"].sentence
