"""Recordings of a rotor with viscous and dry friction, simulated without the package."""

from __future__ import annotations

from typing import Literal

import numpy as np

import greybox_torch as gt

COUNT, STEP = 600, 0.02


def recorded(
    role: Literal["estimation", "validation"],
    seed: int,
    level: float,
    *,
    torques: tuple[float, float],
    sign: float = 1.0,
    factor: float = 1.0,
) -> gt.Recording:
    """Of J 0.3 and b 0.1, with Coulomb friction of a ``level``; the torque is recorded times ``sign``, the speed times ``factor``."""
    draw = np.random.default_rng(seed)
    torque, speed = np.repeat(draw.uniform(*torques, COUNT // 30), 30), np.zeros(COUNT)
    for k in range(COUNT - 1):
        w = speed[k]
        for _ in range(20):
            w += STEP / 20 * (torque[k] - 0.1 * w - level * np.tanh(w / 0.1)) / 0.3
        speed[k + 1] = w
    given = {"torque": sign * torque, "speed": factor * speed + 0.02 * draw.standard_normal(COUNT)}
    return gt.Recording.from_arrays(role, given, sample_time=STEP, role=role)


def recordings(level: float, *, torques: tuple[float, float], sign: float = 1.0, factor: float = 1.0) -> gt.DataSet:
    """One to estimate from and one for validation."""
    how = {"torques": torques, "sign": sign, "factor": factor}
    return gt.DataSet([recorded("estimation", 1, level, **how), recorded("validation", 2, level, **how)])
