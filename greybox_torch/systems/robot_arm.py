"""The three-mass flexible arm of an industrial robot (one axis), the first built-in system."""

from __future__ import annotations

from typing import Any

import torch

from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class RobotArm(GreyBoxModel):
    """Motor, gearbox and arm in series, joined by a cubic gear spring and a linear arm spring, both damped.

    With φ_g the gear twist and φ_a the arm twist (rad), ω the speeds (rad/s), all seen from the motor side::

        τ_f = F_v ω_m + (F_c + F_cs / cosh(α ω_m)) tanh(β ω_m)          motor friction
        τ_g = k_g1 φ_g + k_g3 φ_g³ + d_g (ω_m − ω_g)                    gear
        τ_a = k_a φ_a + d_a (ω_g − ω_a)                                 arm
        J a_m dω_m/dt = τ − τ_f − τ_g
        J a_g dω_g/dt = τ_g − τ_a
        J (1 − a_m − a_g) dω_a/dt = τ_a

    Source: E. Wernholt and S. Gunnarsson, "Nonlinear identification of a physically parameterized robot model", 14th IFAC Symposium
    on System Identification (SYSID), Newcastle, 2006, eqs. (1)-(5); start values as published there.
    """

    name = "robot_arm"
    states = [
        State("gear_twist", "rad", initial=0.0, fixed=True, description="motor angle minus gearbox angle"),
        State("arm_twist", "rad", initial=0.0, fixed=True, description="gearbox angle minus arm angle"),
        State("motor_speed", "rad/s", initial="measured", description="motor angular velocity"),
        State("gearbox_speed", "rad/s", initial="measured", description="gearbox angular velocity"),
        State("arm_speed", "rad/s", initial="measured", description="arm angular velocity"),
    ]
    inputs = [Input("torque", "N m", description="motor torque")]
    outputs = [Output("motor_speed", "rad/s", description="motor angular velocity")]
    parameters = [
        Parameter("F_v", 0.00986346744839, unit="N m s/rad", lower=0.0, description="viscous friction"),
        Parameter("F_c", 0.74302635727901, unit="N m", lower=0.0, description="Coulomb friction"),
        Parameter("F_cs", 3.98628540790595, unit="N m", lower=0.0, description="Stribeck friction level"),
        Parameter("alpha", 3.24015074090438, unit="s/rad", lower=0.0, description="Stribeck smoothness"),
        Parameter("beta", 0.79943497008153, unit="s/rad", lower=0.0, description="friction smoothness"),
        Parameter("J", 0.03291699877416, unit="kg m^2", lower=1e-6, description="total moment of inertia"),
        Parameter(
            "a_m", 0.17910964111956, unit="", lower=1e-3, upper=0.999, description="motor's share of the inertia"
        ),
        Parameter(
            "a_g", 0.61206166914114, unit="", lower=1e-3, upper=0.999, description="gearbox's share of the inertia"
        ),
        Parameter("k_g1", 20.59269827430799, unit="N m/rad", lower=0.0, description="gear stiffness"),
        Parameter("k_g3", 0.0, unit="N m/rad^3", lower=0.0, description="gear cubic stiffness"),
        Parameter("d_g", 0.06241814047290, unit="N m s/rad", lower=0.0, description="gear damping"),
        Parameter("k_a", 20.23072060978318, unit="N m/rad", lower=0.0, description="arm stiffness"),
        Parameter("d_a", 0.00987527995798, unit="N m s/rad", lower=0.0, description="arm damping"),
    ]
    ports = [
        Body("motor", speed="motor_speed", load=lambda x, u, p: gear_spring_torque(x, p)),
        Body("gearbox", speed="gearbox_speed", load=lambda x, u, p: gear_spring_torque(x, p)),
        Body("arm", speed="arm_speed", load=lambda x, u, p: arm_spring_torque(x, p)),
        Coupling("gear_spring", deflection="gear_twist", rate=lambda x, u, p: x.motor_speed - x.gearbox_speed),
        Coupling("arm_spring", deflection="arm_twist", rate=lambda x, u, p: x.gearbox_speed - x.arm_speed),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        stribeck = p.F_cs / torch.cosh(
            (p.alpha * x.motor_speed).clamp(-80.0, 80.0)
        )  # zero beyond; cosh itself overflows
        friction = p.F_v * x.motor_speed + (p.F_c + stribeck) * torch.tanh(p.beta * x.motor_speed)
        gear = gear_torque(x, p) + port.gear_spring
        arm = arm_torque(x, p) + port.arm_spring
        return {
            "gear_twist": x.motor_speed - x.gearbox_speed,
            "arm_twist": x.gearbox_speed - x.arm_speed,
            "motor_speed": (u.torque - friction - gear + port.motor) / (p.J * p.a_m),
            "gearbox_speed": (gear - arm + port.gearbox) / (p.J * p.a_g),
            "arm_speed": (arm + port.arm) / (p.J * (1 - p.a_m - p.a_g)),
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"motor_speed": x.motor_speed}

    def admissible(self, p: Any) -> dict[str, Any]:
        return {"1 - a_m - a_g (the arm's share of the inertia)": 1 - p.a_m - p.a_g - 1e-4}


def gear_spring_torque(x: Any, p: Any) -> Any:
    """Elastic torque through the gear, N m: the load that presses its teeth."""
    return p.k_g1 * x.gear_twist + p.k_g3 * x.gear_twist**3


def gear_torque(x: Any, p: Any) -> Any:
    """Torque through the gear, N m: cubic spring and damper."""
    return gear_spring_torque(x, p) + p.d_g * (x.motor_speed - x.gearbox_speed)


def arm_spring_torque(x: Any, p: Any) -> Any:
    """Elastic torque through the arm, N m."""
    return p.k_a * x.arm_twist


def arm_torque(x: Any, p: Any) -> Any:
    """Torque through the arm, N m: linear spring and damper."""
    return arm_spring_torque(x, p) + p.d_a * (x.gearbox_speed - x.arm_speed)
