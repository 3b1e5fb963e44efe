"""Drive and sensor of the arm."""

from __future__ import annotations

from numpy.random import Generator

from experiments.concealed.catalogue.arm_twins import BIAS, DELAY, LAG
from experiments.concealed.effects import Effect, Surroundings, Switches, sign
from experiments.concealed.laws import drive


def drive_effects() -> list[Effect]:
    def delay(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"delay": s * g.uniform(0.001, 0.003)}

    return [
        Effect(
            name="input_delay",
            law=drive.InputDelay,
            port="actuator",
            family="timing",
            draw=delay,
            accept=DELAY,
            near=LAG,
            ports=("actuator", "sensor"),
        ),
        Effect(
            name="output_delay",
            law=drive.OutputDelay,
            port="sensor",
            family="timing",
            draw=delay,
            accept=DELAY,
            near=LAG,
            ports=("actuator", "sensor"),
        ),
        Effect(
            name="input_lag",
            law=drive.InputLag,
            port="actuator",
            family="timing",
            draw=lambda g, s, c: {"T": s * g.uniform(0.0015, 0.0035)},
            accept=LAG[:1],
            near=(*DELAY, LAG[1]),
            ports=("actuator",),
        ),
        Effect(
            name="sensor_lag",
            law=drive.SensorLag,
            port="sensor",
            family="timing",
            draw=lambda g, s, c: {"T": s * g.uniform(0.0015, 0.0035)},
            accept=LAG[1:],
            near=(*DELAY, LAG[0]),
            ports=("sensor",),
        ),
        Effect(
            name="input_bias",
            law=drive.InputBias,
            port="actuator",
            family="bias",
            draw=lambda g, s, c: {"bias": s * sign(g) * g.uniform(0.03, 0.1)},
            accept=BIAS,
            near=(("motor", "coulomb_asymmetry"),),
            ports=("motor", "gearbox", "arm", "actuator"),
        ),
        Effect(
            name="saturation",
            law=drive.TorqueSaturation,
            port="actuator",
            family="actuator",
            draw=lambda g, s, c: {"limit": g.uniform(8.0, 10.0) / s**0.2},
            accept=(("actuator", "torque_saturation"),),
            ports=("actuator",),
        ),
        Effect(
            name="deadzone",
            law=drive.ActuatorDeadzone,
            port="actuator",
            family="actuator",
            draw=lambda g, s, c: {"half_width": s * g.uniform(0.1, 0.2)},
            accept=(("actuator", "actuator_deadzone"),),
            ports=("actuator",),
        ),
        Effect(
            name="sensor_bias",
            law=drive.SensorBias,
            port="sensor",
            family="bias",
            draw=lambda g, s, c: {"bias": s * sign(g) * g.uniform(0.25, 0.6)},
            accept=(("sensor", "sensor_bias"),),
            ports=("sensor",),
        ),
    ]
