"""Four small machines whose first recordings leave questions open: one direction only, slow, or small."""

from __future__ import annotations

from experiments.resolving.machines.base import Limited, Question
from experiments.resolving.machines.car import QuarterCar
from experiments.resolving.machines.drive import GearedDrive
from experiments.resolving.machines.motor import Motor
from experiments.resolving.machines.pendulum import Pendulum

MACHINES: dict[str, Limited] = {m.name: m for m in (Motor(), Pendulum(), GearedDrive(), QuarterCar())}

QUESTIONS: tuple[Question, ...] = (
    Question("bias or asymmetry", "motor", ("bias", "coulomb", "uneven"), (3.0, 8.0)),
    Question("lag or delay", "motor", ("voltage_lag", "voltage_delay"), (0.3, 1.2)),
    Question("actuator or sensor", "pendulum", ("torque_lag", "angle_slow", "torque_delay", "angle_late"), (1.0, 4.0)),
    Question("offset or force", "pendulum", ("offset", "bias", "imbalance"), (5.0, 15.0)),
    Question("either side of a gear", "drive", ("motor_coulomb", "load_coulomb"), (0.5, 1.5)),
    Question("stiffness or damping", "car", ("cubic", "one_way", "drag"), (0.7, 1.6)),
)
"""Drawn in turn."""
