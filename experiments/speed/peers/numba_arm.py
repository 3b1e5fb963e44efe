"""The arm in Numba: plain loops over Runge-Kutta steps, records side by side on the cores."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

STATES = 5
PARAMETERS = 13


@njit(cache=False)
def rates(x, torque, p, out):
    """dx/dt of the five states into ``out``, parameters in the order of the model."""
    motor = x[2]
    stribeck = p[2] / math.cosh(min(max(p[3] * motor, -80.0), 80.0))
    friction = p[0] * motor + (p[1] + stribeck) * math.tanh(p[4] * motor)
    gear = p[8] * x[0] + p[9] * x[0] * x[0] * x[0] + p[10] * (motor - x[3])
    spring = p[11] * x[1] + p[12] * (x[3] - x[4])
    out[0] = motor - x[3]
    out[1] = x[3] - x[4]
    out[2] = (torque - friction - gear) / (p[5] * p[6])
    out[3] = (gear - spring) / (p[5] * p[7])
    out[4] = spring / (p[5] * (1.0 - p[6] - p[7]))


@njit(cache=False)
def simulate(p, x0, u, h, y):
    """Motor speed into ``y`` (N,), for parameters (13,), start state (5,), torque (N,) held over each sample of ``h`` s."""
    x, z = x0.copy(), np.empty(STATES)
    k1, k2, k3, k4 = np.empty(STATES), np.empty(STATES), np.empty(STATES), np.empty(STATES)
    for n in range(len(u)):
        y[n] = x[2]
        rates(x, u[n], p, k1)
        for i in range(STATES):
            z[i] = x[i] + 0.5 * h * k1[i]
        rates(z, u[n], p, k2)
        for i in range(STATES):
            z[i] = x[i] + 0.5 * h * k2[i]
        rates(z, u[n], p, k3)
        for i in range(STATES):
            z[i] = x[i] + h * k3[i]
        rates(z, u[n], p, k4)
        for i in range(STATES):
            x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])


@njit(parallel=True, cache=False)
def free_run(p, x0, u, h):
    """Speeds (E, N), for parameters and start states of each run (E, 13) and (E, 5), and torques (E, N)."""
    y = np.empty(u.shape)
    for e in prange(len(u)):
        simulate(p[e], x0[e], u[e], h, y[e])
    return y
