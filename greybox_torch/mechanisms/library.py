"""The hypothesis library: every mechanism by its name, and the way to add one and to take it out again."""

from __future__ import annotations

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.actuator import InputBias, InputDelay, InputGain, InputLag, TorqueSaturation
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.balance import LinearLeak, ThresholdFlow
from greybox_torch.mechanisms.check import check_mechanism
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.forces import AdditionalMode, ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction, QuadraticDrag, ViscousFriction
from greybox_torch.mechanisms.friction_net import FrictionNet
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.memory_net import MemoryNet
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.mechanisms.sensor import OutputDelay, SensorBias, SensorGain, SensorLag
from greybox_torch.mechanisms.stiffness import NonlinearStiffness
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission import Backlash, HystereticSpring, NonlinearDamping
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.unknown_fading import UnknownFading
from greybox_torch.mechanisms.unknown_map import UnknownMap
from greybox_torch.mechanisms.unknown_play import UnknownPlay
from greybox_torch.mechanisms.unknown_rate_limit import UnknownRateLimit
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory
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

LEARNED: dict[str, type[Mechanism]] = {
    learned.name: learned
    for learned in (
        Unknown,
        UnknownWithMemory,
        UnknownFading,
        UnknownMap,
        UnknownPlay,
        UnknownRateLimit,
        FrictionNet,
        ResidualNet,
        MemoryNet,
    )
}
"""Curves and networks that are learned where no law has a name; never hypotheses of their own."""


BUILT_IN = frozenset(LIBRARY)


def register(mechanism: type[Mechanism]) -> type[Mechanism]:
    """Add a mechanism to the library, so that it takes part in every diagnosis (usable as a class decorator in a user's own file).

    The same class from the same module, run again, takes the place of the earlier one.

    Raises:
        UserError: an attribute or method of the class is missing or wrong, or another mechanism has the name.
    """
    check_mechanism(mechanism)
    name, there = mechanism.name, {**LEARNED, **LIBRARY}.get(mechanism.name)
    if there is not None and (there.__module__, there.__qualname__) != (mechanism.__module__, mechanism.__qualname__):
        raise UserError(
            f"register: mechanism {mechanism.__name__}: the name '{name}' is taken by {there.__module__}.{there.__qualname__}; "
            f"expected a name that is not in the library"
        )
    LIBRARY[name] = mechanism
    return mechanism


def unregister(name: str) -> None:
    """Take a mechanism of one's own out of the library again.

    Raises:
        UserError: the library does not have it, or it came with the package.
    """
    if name in BUILT_IN or name not in LIBRARY:
        own = ", ".join(n for n in LIBRARY if n not in BUILT_IN) or "none"
        why = "came with the package" if name in BUILT_IN else "is not in the library"
        raise UserError(f"unregister: mechanism '{name}' {why}; registered are: {own}")
    del LIBRARY[name]
