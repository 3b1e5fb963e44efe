from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import load_model


@pytest.fixture(scope="module")
def motor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'motor.py'}:Motor")


@pytest.fixture(scope="module")
def experiments(motor_speed: Any) -> list[dict[str, np.ndarray]]:
    """Two noise-free experiments of different length, starting at 2 and −1 rad/s."""
    rng = np.random.default_rng(0)
    volts = [np.repeat(rng.uniform(-5, 5, n // 20), 20) for n in (400, 240)]
    return [{"voltage": v, "speed": motor_speed(v, start=s)} for v, s in zip(volts, (2.0, -1.0), strict=True)]
