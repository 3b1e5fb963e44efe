"""Concealed laws on random states side by side."""

from __future__ import annotations

from typing import Any

import numpy as np

from experiments.concealed.laws import Law, Motion

SAMPLE_TIME = 0.0005
LANES = 200


def make(law: type[Law], port: str, lanes: int = LANES, **switches: float) -> Any:
    return law(np.arange(lanes), {name: np.full(lanes, value) for name, value in switches.items()}, port)


def motion(law: Law, *, memory: np.ndarray | None = None) -> Motion:
    """Random states on `LANES` lanes: twists, speeds, position, and the law's memory."""
    rng = np.random.default_rng(0)
    state = np.zeros((6 + law.memory, LANES))
    state[:2] = rng.normal(scale=0.1, size=(2, LANES))
    state[2:5] = rng.normal(scale=15.0, size=(3, LANES))
    state[5] = rng.uniform(-30.0, 30.0, LANES)
    law.first_row, law.sample_time, law.step = 6, SAMPLE_TIME, SAMPLE_TIME / 8
    if memory is not None:
        state[6:] = memory
    m = Motion(0.5, state, rng.normal(scale=5.0, size=LANES))
    m.gear_spring = 20.0 * m.gear_deflection
    m.gear_torque = m.gear_spring + 0.03 * m.gear_rate
    m.arm_torque = 11.0 * m.arm_deflection + 0.003 * m.arm_rate
    m.motor_force = np.zeros(LANES)
    return m
