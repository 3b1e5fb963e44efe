"""The machines of the proof, by name."""

from __future__ import annotations

from experiments.concealed.machines.arm import Arm
from experiments.concealed.machines.base import Machine
from experiments.concealed.machines.engine_cart import EngineCart
from experiments.concealed.machines.engine_drive import EngineDrive
from experiments.concealed.machines.engine_pendulum import EnginePendulum
from experiments.concealed.machines.engine_two_link import EngineTwoLink
from experiments.concealed.machines.pendulum import Pendulum
from experiments.concealed.machines.stage import Stage

OWN: dict[str, Machine] = {machine.name: machine for machine in (Arm(), Stage(), Pendulum())}
"""On the plants that are written here."""
ENGINE: dict[str, Machine] = {m.name: m for m in (EnginePendulum(), EngineDrive(), EngineCart(), EngineTwoLink())}
"""In MuJoCo."""
MACHINES = OWN | ENGINE
