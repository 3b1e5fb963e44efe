"""The machines of the workshop, by name."""

from __future__ import annotations

from experiments.concealed.workshop.machines.balancer import Balancer
from experiments.concealed.workshop.machines.ball_screw import BallScrew
from experiments.concealed.workshop.machines.cylinder import Cylinder
from experiments.concealed.workshop.machines.furuta import Furuta
from experiments.concealed.workshop.machines.gimbal import Gimbal
from experiments.concealed.workshop.machines.heater import Heater
from experiments.concealed.workshop.machines.pump import Pump
from experiments.concealed.workshop.machines.voice_coil import VoiceCoil
from experiments.concealed.workshop.machines.winch import Winch
from experiments.concealed.workshop.plant import Machine

WORKSHOP: dict[str, Machine] = {
    m.name: m for m in (BallScrew(), Cylinder(), Winch(), Pump(), Heater(), Gimbal(), Furuta(), VoiceCoil(), Balancer())
}
