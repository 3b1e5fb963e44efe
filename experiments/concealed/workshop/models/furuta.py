import torch

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class RotaryPendulum(GreyBoxModel):
    """An arm turned by a motor; a pendulum hangs at its end."""

    states = [
        State("arm", "rad", initial="measured"),
        State("pendulum", "rad", initial="measured"),
        State("arm_speed", "rad/s"),
        State("pendulum_speed", "rad/s"),
    ]
    inputs = [Input("voltage", "V")]
    outputs = [Output("arm", "rad"), Output("pendulum", "rad")]
    parameters = [
        Parameter("Ja", 0.004, unit="kg m^2", lower=1e-5),
        Parameter("Jp", 0.0012, unit="kg m^2", lower=1e-5),
        Parameter("ml", 0.009, unit="kg m", lower=0.0),
        Parameter("mlr", 0.0016, unit="kg m^2", lower=0.0),
        Parameter("K", 0.04, unit="N m/V", lower=0.0, fixed=True),
        Parameter("ba", 0.004, unit="N m s/rad", lower=0.0),
        Parameter("bp", 1e-4, unit="N m s/rad", lower=0.0),
    ]
    ports = [
        Body("arm", speed="arm_speed", position="arm"),
        Body("pendulum", speed="pendulum_speed", position="pendulum"),
    ]

    def derivative(self, x, u, p, port):
        s, c = torch.sin(x.pendulum), torch.cos(x.pendulum)
        w, v = x.arm_speed, x.pendulum_speed
        m11, m12, m22 = p.Ja + p.Jp * s**2, p.mlr * c, p.Jp
        t1 = p.K * u.voltage - p.ba * w - 2 * p.Jp * s * c * w * v + p.mlr * s * v**2 + port.arm
        t2 = p.Jp * s * c * w**2 - 9.81 * p.ml * s - p.bp * v + port.pendulum
        det = m11 * m22 - m12**2
        return {
            "arm": w,
            "pendulum": v,
            "arm_speed": (m22 * t1 - m12 * t2) / det,
            "pendulum_speed": (m11 * t2 - m12 * t1) / det,
        }

    def output(self, x, u, p):
        return {"arm": x.arm, "pendulum": x.pendulum}
