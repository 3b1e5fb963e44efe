"""A motor and a load on a flexible shaft."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class DriveTrain(GreyBoxModel):
    """Jm dwm/dt = τ − T − dm wm, Jl dwl/dt = T − dl wl, with T = k (qm − ql) + c (wm − wl) in the shaft."""

    name = "drive_train"
    states = [
        State("qm", "rad", initial="measured"),
        State("ql", "rad", initial="measured"),
        State("wm", "rad/s"),
        State("wl", "rad/s"),
    ]
    inputs = [Input("torque", "N m")]
    outputs = [Output("motor_angle", "rad"), Output("load_angle", "rad")]
    parameters = [
        Parameter("Jm", 0.012, unit="kg m^2", lower=1e-5, description="inertia of the motor"),
        Parameter("Jl", 0.04, unit="kg m^2", lower=1e-5, description="inertia of the load"),
        Parameter("k", 40.0, unit="N m/rad", lower=0.0, description="stiffness of the shaft"),
        Parameter("c", 0.06, unit="N m s/rad", lower=0.0, description="damping of the shaft"),
        Parameter("dm", 0.02, unit="N m s/rad", lower=0.0, description="viscous friction of the motor"),
        Parameter("dl", 0.02, unit="N m s/rad", lower=0.0, description="viscous friction of the load"),
    ]
    ports = [
        Body("motor", speed="wm", position="qm"),
        Body("load", speed="wl", position="ql"),
        Coupling("shaft", deflection=lambda x, u, p: x.qm - x.ql, rate=lambda x, u, p: x.wm - x.wl),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        torque = p.k * (x.qm - x.ql) + p.c * (x.wm - x.wl) + port.shaft
        motor = u.torque - torque - p.dm * x.wm + port.motor
        load = torque - p.dl * x.wl + port.load
        return {"qm": x.wm, "ql": x.wl, "wm": motor / p.Jm, "wl": load / p.Jl}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"motor_angle": x.qm, "load_angle": x.ql}
