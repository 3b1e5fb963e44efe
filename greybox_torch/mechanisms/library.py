"""The hypothesis library: every mechanism by its name, and the way to add one."""

from __future__ import annotations

from greybox_torch.mechanisms.actuator import (
    ActuatorDeadzone,
    InputBias,
    InputDelay,
    InputGain,
    InputLag,
    TorqueSaturation,
)
from greybox_torch.mechanisms.balance import LinearLeak, ThresholdFlow
from greybox_torch.mechanisms.forces import AdditionalMode, ConstantBias, EndStop, Gravity, TorqueRipple
from greybox_torch.mechanisms.friction import (
    CoulombAsymmetry,
    CoulombFriction,
    QuadraticDrag,
    StribeckFriction,
    ViscousFriction,
)
from greybox_torch.mechanisms.friction_net import FrictionNet
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.mechanisms.sensor import OutputDelay, SensorBias, SensorGain, SensorLag
from greybox_torch.mechanisms.transmission import Backlash, HystereticSpring, NonlinearDamping, NonlinearStiffness
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.varying_friction import FrictionWarmup, LoadDependentFriction, PositionDependentFriction

LIBRARY: dict[str, type[Mechanism]] = {
    mechanism.name: mechanism
    for mechanism in (
        ViscousFriction,
        CoulombFriction,
        StribeckFriction,
        CoulombAsymmetry,
        QuadraticDrag,
        LoadDependentFriction,
        PositionDependentFriction,
        FrictionWarmup,
        PreslidingHysteresis,
        ConstantBias,
        Gravity,
        TorqueRipple,
        EndStop,
        AdditionalMode,
        Backlash,
        NonlinearStiffness,
        HystereticSpring,
        NonlinearDamping,
        TransmissionError,
        LinearLeak,
        ThresholdFlow,
        InputDelay,
        InputLag,
        InputBias,
        InputGain,
        TorqueSaturation,
        ActuatorDeadzone,
        OutputDelay,
        SensorLag,
        SensorBias,
        SensorGain,
    )
}

LEARNED: dict[str, type[Mechanism]] = {curve.name: curve for curve in (Unknown, FrictionNet, ResidualNet)}
"""Curves and networks that are learned where no law has a name; never hypotheses of their own."""


def register(mechanism: type[Mechanism]) -> type[Mechanism]:
    """Add a mechanism to the library (usable as a class decorator in a user's own file)."""
    LIBRARY[mechanism.name] = mechanism
    return mechanism
