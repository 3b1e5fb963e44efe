"""Answers that are the same physics on the arm, as far as torque and motor speed can tell (see `arm.py`)."""

from __future__ import annotations

from experiments.concealed.effects import Pair

BIAS: tuple[Pair, ...] = (
    ("motor", "constant_bias"),
    ("actuator", "input_bias"),
    ("gearbox", "constant_bias"),
    ("arm", "constant_bias"),
)
DELAY: tuple[Pair, ...] = (("actuator", "input_delay"), ("sensor", "output_delay"))
LAG: tuple[Pair, ...] = (("actuator", "input_lag"), ("sensor", "sensor_lag"))
BODIES = ("motor", "gearbox", "arm")
DRY_NAMES = ("coulomb_friction", "stribeck_friction", "presliding_hysteresis")
