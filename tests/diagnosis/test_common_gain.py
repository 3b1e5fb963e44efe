"""A gain error that recordings cannot show: what the moves of re-estimated parameters say of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import greybox_torch as gt
from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.diagnosis.common_gain import common_gain
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.sensor import SensorGain

SETTINGS = gt.DiagnosisSettings()
EFFECT = Attachment("sensor.i", SensorGain())
EXPONENTS = np.array([1.0, 1.0, 0.0, -1.0, -1.0])
"""Of R, L, k, J and b, where the current is recorded with another gain."""

TRUE = {"R": 1.4, "L": 2e-3, "k": 0.05, "J": 5e-5, "b": 4e-5}


class MotorWithWinding(GreyBoxModel):
    """Brushed motor: L di/dt = u - R i - k w, J dw/dt = k i - b w."""

    states = [State("i", "A", initial="measured"), State("w", "rad/s", initial="measured")]
    inputs = [Input("u", "V")]
    outputs = [Output("i", "A"), Output("w", "rad/s")]
    parameters = [
        Parameter("R", TRUE["R"], "Ohm", lower=0.0),
        Parameter("L", TRUE["L"], "H", lower=1e-6),
        Parameter("k", TRUE["k"], "N m/A", lower=0.0),
        Parameter("J", TRUE["J"], "kg m^2", lower=1e-9),
        Parameter("b", TRUE["b"], "N m s/rad", lower=0.0),
    ]
    ports = [Body("rotor", speed="w")]

    def derivative(self, x, u, p, port):
        return {"i": (u.u - p.R * x.i - p.k * x.w) / p.L, "w": (p.k * x.i - p.b * x.w + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"i": x.i, "w": x.w}


def recorded(name: str, role: str, seed: int, sensor: float, step: float = 5e-4, samples: int = 2500) -> gt.Recording:
    """The motor as a linear system that is discretised exactly, its current sensor showing ``sensor`` times the current."""
    rng, t = np.random.default_rng(seed), TRUE
    u = np.repeat(rng.uniform(-8.0, 8.0, samples // 50 + 1), 50)[:samples]
    a = np.array([[-t["R"] / t["L"], -t["k"] / t["L"]], [t["k"] / t["J"], -t["b"] / t["J"]]])
    whole = expm(step * np.block([[a, np.array([[1.0 / t["L"]], [0.0]])], [np.zeros((1, 3))]]))
    x, states = np.zeros(2), []
    for v in u:
        states.append(x)
        x = whole[:2, :2] @ x + whole[:2, 2] * v
    i, w = np.array(states).T
    channels = {
        "u": u,
        "i": sensor * i + 0.02 * rng.standard_normal(samples),
        "w": w + 0.3 * rng.standard_normal(samples),
    }
    return gt.Recording.from_arrays(name, channels, sample_time=step, role=role)


def diagnosed(sensor: float, card: dict[str, float]) -> gt.DiagnosisResult:
    model = MotorWithWinding()
    model.set_values(card)
    data = gt.DataSet(
        [recorded("first", "estimation", 1, sensor), recorded("second", "validation", 2, sensor)], name="motor"
    )
    return gt.diagnose(model, data)


def test_the_error_is_that_which_the_moves_show() -> None:
    scatter = np.array([0.02, -0.01, 0.01, 0.015, -0.02])
    found = common_gain(EFFECT, scatter - EXPONENTS * np.log(0.8), EXPONENTS, 3, SETTINGS)
    assert found is not None
    assert abs(found.error + 0.2) < 2 * found.deviation < 0.04
    assert found.share > 0.98 and found.chance < SETTINGS.chance_of_common_gain


def test_moves_at_random_are_told_as_a_gain_as_rarely_as_the_setting_says() -> None:
    rng, looks = np.random.default_rng(0), 3
    settings = gt.DiagnosisSettings(chance_of_common_gain=0.05)
    told = [common_gain(EFFECT, 0.06 * rng.standard_normal(5), EXPONENTS, looks, settings) for _ in range(3000)]
    assert 0 < sum(t is not None for t in told) < 3000 * 0.05 / looks * 1.3


@pytest.mark.parametrize(
    ("moves", "exponents", "why"),
    [
        (-EXPONENTS * np.log(0.97), EXPONENTS, "a gain error of 3 % is none"),
        (
            np.array([1.0, 0.0, 0.0, 0.0, 0.0]),
            np.array([1.0, 0.0, 0.0, 0.0, 0.0]),
            "one parameter alone is re-estimated",
        ),
        (0.3 * np.array([1.0, -1.0, 1.0, 1.0, -1.0]) - EXPONENTS, EXPONENTS, "a card that is far off says nothing"),
        (np.array([0.2]), np.array([1.0]), "one parameter"),
        (EXPONENTS, np.full(5, np.nan), "exponents without a number"),
    ],
)
def test_what_is_no_gain_error(moves: np.ndarray, exponents: np.ndarray, why: str) -> None:
    assert common_gain(EFFECT, moves, exponents, 1, SETTINGS) is None, why


def test_a_current_sensor_that_reads_low_is_named_where_the_card_is_good() -> None:
    card = {n: v * f for (n, v), f in zip(TRUE.items(), (1.02, 0.99, 1.01, 0.98, 1.01), strict=True)}
    found = diagnosed(0.8, card)
    (effect,) = found.verdict.effects
    assert (effect.port, effect.mechanism) == ("sensor.i", "sensor_gain")
    error = effect.parameters["gain_error"]
    assert abs(error["value"] + 0.2) < 3 * error["std"] < 0.1
    assert "R, L, J and b make up for it" in found.sentence
    assert found.verdict.mismatch and found.verdict.confidence == effect.probability
    assert found.verdict.left is not None and "As much remains as without it" in found.verdict.left.sentence
    values = found.model.values()
    assert all(abs(np.log(values[n] / TRUE[n])) < 0.05 for n in TRUE)


@pytest.mark.parametrize("sensor", [1.0, 0.8])
def test_a_card_that_is_off_says_nothing(sensor: float) -> None:
    card = {n: v * f for (n, v), f in zip(TRUE.items(), (1.14, 0.88, 1.1, 1.12, 0.87), strict=True)}
    found = diagnosed(sensor, card)
    assert not found.verdict.effects and not found.verdict.mismatch
