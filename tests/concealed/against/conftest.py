"""A case that is small enough to be run in seconds: a motor with quadratic drag, or without, that the model does not know."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from experiments.concealed.against.plain import Plain, retune

SAMPLE_TIME, SAMPLES, NOISE = 0.01, 600, 0.01
MOTOR = Path(__file__).parents[2] / "machines" / "motor.py"
DRAG = 0.02
"""N m s^2/rad^2, where there is drag."""

CARD = f"""\
name = "Bench motor"
sample_time = {SAMPLE_TIME}
hold = "zoh"
[channels]
voltage = {{ column = "v", unit = "V" }}
speed = {{ column = "w", unit = "rad/s" }}
[[experiment]]
name = "Steps"
file = "steps.csv"
role = "estimation"
[[experiment]]
name = "More steps"
file = "more.csv"
role = "validation"
[model]
name = "{MOTOR}:Motor"
[model.parameters]
J = {{ value = 0.02 }}
"""


def record(seed: int, drag: float) -> np.ndarray:
    """Voltage and measured speed (N, 2) of a motor with J 0.02 kg m^2, k 0.1 N m/V, b 0.03 N m s/rad, and drag."""
    rng = np.random.default_rng(seed)
    voltage = np.repeat(rng.uniform(-3.0, 3.0, SAMPLES // 20), 20)
    rates = lambda t, w, v: (0.1 * v - 0.03 * w - drag * w * abs(w)) / 0.02  # noqa: E731
    speed = np.zeros(SAMPLES)
    for k in range(SAMPLES - 1):
        step = solve_ivp(rates, (0.0, SAMPLE_TIME), [speed[k]], args=(voltage[k],), rtol=1e-8, atol=1e-10)
        speed[k + 1] = step.y[0, -1]
    return np.stack([voltage, speed + NOISE * rng.standard_normal(SAMPLES)], axis=1)


def write(folder: Path, drag: float) -> Path:
    folder.mkdir(parents=True)
    for seed, name in enumerate(("steps", "more")):
        np.savetxt(folder / f"{name}.csv", record(seed, drag), delimiter=",", header="v,w", comments="")
    (folder / "dataset.toml").write_text(CARD)
    effects = ["quadratic_drag"] if drag else ["none"]
    accept = [[["rotor", "quadratic_drag"]]] if drag else [[]]
    key = {"effects": effects, "accept": accept, "near": [[]], "ports": [["rotor"]] if drag else [[]], "sigma": NOISE}
    (folder / "key.json").write_text(json.dumps({**key, "outside": [False] * bool(drag)}))
    return folder


@pytest.fixture(scope="session")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two cases, "drag" and "plain"."""
    root = tmp_path_factory.mktemp("cases")
    write(root / "drag", DRAG)
    write(root / "plain", 0.0)
    return root


@pytest.fixture(scope="session")
def tuned(cases: Path) -> Callable[[str], Plain]:
    """A case by name, its model re-tuned."""
    found: dict[str, Plain] = {}

    def get(name: str) -> Plain:
        if name not in found:
            found[name] = retune(cases / name / "dataset.toml")
        return found[name]

    return get
