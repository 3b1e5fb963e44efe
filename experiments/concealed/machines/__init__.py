"""The machines of the proof, by name."""

from __future__ import annotations

from experiments.concealed.machines.arm import Arm
from experiments.concealed.machines.base import Machine
from experiments.concealed.machines.pendulum import Pendulum
from experiments.concealed.machines.stage import Stage

MACHINES: dict[str, Machine] = {machine.name: machine for machine in (Arm(), Stage(), Pendulum())}
