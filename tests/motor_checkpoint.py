"""A checkpoint to write and read."""

from __future__ import annotations

from greybox_torch.checkpoint import (
    Checkpoint,
)

MOTOR = Checkpoint(
    model="/somewhere/my_motor.py:Motor",
    title="Motor",
    values={"J": 0.0123456789012345678, "k_1.2": -1e-300, "b": 0.0},
    units={"J": "kg m^2", "k_1.2": "N m/V", "b": ""},
    effects=[{"port": "rotor", "mechanism": "gravity", "parameters": {"level": 2.0}}],
    dataset="abc",
    figures=[{"experiment": "one", "refit": {"fit": 99.5, "rmse": 0.1}}],
)
