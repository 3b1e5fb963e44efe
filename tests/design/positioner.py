"""A motor that carries a load on top, held by a controller, with dry friction: simulated by code that the package does not share."""

from __future__ import annotations

import numpy as np

STEP, INERTIA, GAIN, DAMPING, LEVEL, TIPPING = 0.01, 0.02, 0.1, 0.05, 0.02, 0.05
LOOP = {"measured": "angle", "gain": 20.0, "integral": 1.0, "derivative": 0.1}
LARGEST, SPAN = 3.0, 0.5
"""Limits of the voltage, and of the angle, each way."""

MODEL = '''"""A motor with a load that tips over."""

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Positioner(GreyBoxModel):
    """J dw/dt = k v - b w + m a."""

    states = [State("angle", "rad"), State("speed", "rad/s", initial=0.0)]
    inputs = [Input("voltage", "V")]
    outputs = [Output("angle", "rad")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=0.0),
        Parameter("k", 0.10, unit="N m/V", lower=0.0, fixed=True),
        Parameter("b", 0.05, unit="N m s/rad", lower=0.0),
        Parameter("m", 0.05, unit="N m/rad", lower=0.0, fixed=True),
    ]
    ports = [Body("rotor", speed="speed", position="angle")]

    def derivative(self, x, u, p, port):
        return {"angle": x.speed, "speed": (p.k * u.voltage - p.b * x.speed + p.m * x.angle + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"angle": x.angle}
'''

CARD = f"""name = "Positioner"
sample_time = {STEP}

[channels]
voltage = {{ column = "voltage", unit = "V" }}
angle = {{ column = "angle", unit = "rad" }}

[[experiment]]
name = "up"
file = "up.csv"

[[experiment]]
name = "more"
file = "more.csv"
role = "validation"

[model]
name = "positioner.py:Positioner"

[limits]
seconds = 2.0
voltage = {{ lower = -{LARGEST}, upper = {LARGEST}, rate = 400.0 }}
angle = {{ lower = -{SPAN}, upper = {SPAN}, rate = 4.0 }}

[controller]
voltage = {{ measured = "angle", gain = 20.0, integral = 1.0, derivative = 0.1 }}
"""


def held(reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Voltages and angles (N,) of the machine from rest on set points (N,); friction holds it. Euler's rule, 100 steps a sample."""
    angle, speed, total, before, step = 0.0, 0.0, 0.0, 0.0, STEP / 100
    rows: list[tuple[float, float]] = []
    for r in reference:
        free = 20.0 * (r - angle + total - 0.1 * (angle - before) / STEP)
        voltage = min(max(free, -LARGEST), LARGEST)
        total, before = total + (1.0 * STEP * (r - angle) if voltage == free else 0.0), angle
        rows.append((voltage, angle))
        for _ in range(100):
            drive = GAIN * voltage - DAMPING * speed + TIPPING * angle
            if speed == 0.0 and abs(drive) <= LEVEL:
                continue
            direction = np.sign(speed) if speed != 0.0 else np.sign(drive)
            moved = speed + step * (drive - LEVEL * direction) / INERTIA
            speed = 0.0 if speed * moved < 0.0 else moved
            angle += step * speed
    voltages, angles = np.array(rows).T
    return voltages, angles
