"""Forward sensitivities of the arm in Numba: derivatives by hand, directions as the inner loop."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from experiments.speed.peers.numba_arm import PARAMETERS, STATES


@njit(cache=False)
def slopes(x, torque, p, value, by_state, by_parameter):
    """dx/dt into ``value`` (5,), its derivatives to the states (5, 5) and to the parameters (5, 13) where they are not always zero."""
    motor = x[2]
    inside = min(max(p[3] * motor, -80.0), 80.0)
    bell, curve = 1.0 / math.cosh(inside), math.tanh(p[4] * motor)
    level, falling, rising = p[1] + p[2] * bell, -p[2] * bell * math.tanh(inside), 1.0 - curve * curve
    friction = p[0] * motor + level * curve
    by_motor = p[0] + falling * p[3] * curve + level * rising * p[4]
    cube = x[0] * x[0] * x[0]
    gear = p[8] * x[0] + p[9] * cube + p[10] * (motor - x[3])
    spring = p[11] * x[1] + p[12] * (x[3] - x[4])
    stiffness = p[8] + 3.0 * p[9] * x[0] * x[0]
    m, g, a = 1.0 / (p[5] * p[6]), 1.0 / (p[5] * p[7]), 1.0 / (p[5] * (1.0 - p[6] - p[7]))
    value[0], value[1] = motor - x[3], x[3] - x[4]
    value[2], value[3], value[4] = (torque - friction - gear) * m, (gear - spring) * g, spring * a
    by_state[0, 2], by_state[0, 3], by_state[1, 3], by_state[1, 4] = 1.0, -1.0, 1.0, -1.0
    by_state[2, 0], by_state[2, 2], by_state[2, 3] = -stiffness * m, -(by_motor + p[10]) * m, p[10] * m
    by_state[3, 0], by_state[3, 1], by_state[3, 2] = stiffness * g, -p[11] * g, p[10] * g
    by_state[3, 3], by_state[3, 4] = -(p[10] + p[12]) * g, p[12] * g
    by_state[4, 1], by_state[4, 3], by_state[4, 4] = p[11] * a, p[12] * a, -p[12] * a
    by_parameter[2, 0], by_parameter[2, 1], by_parameter[2, 2] = -motor * m, -curve * m, -bell * curve * m
    by_parameter[2, 3], by_parameter[2, 4] = -falling * motor * curve * m, -level * rising * motor * m
    by_parameter[2, 5], by_parameter[2, 6] = -value[2] / p[5], -value[2] / p[6]
    by_parameter[3, 5], by_parameter[3, 7] = -value[3] / p[5], -value[3] / p[7]
    by_parameter[4, 5] = -value[4] / p[5]
    by_parameter[4, 6] = by_parameter[4, 7] = value[4] * a * p[5]
    by_parameter[2, 8], by_parameter[3, 8] = -x[0] * m, x[0] * g
    by_parameter[2, 9], by_parameter[3, 9] = -cube * m, cube * g
    by_parameter[2, 10], by_parameter[3, 10] = -(motor - x[3]) * m, (motor - x[3]) * g
    by_parameter[3, 11], by_parameter[4, 11] = -x[1] * g, x[1] * a
    by_parameter[3, 12], by_parameter[4, 12] = -(x[3] - x[4]) * g, (x[3] - x[4]) * a


@njit(cache=False)
def tangent(by_state, by_parameter, dx, seed, out):
    """Directional derivatives of the rates into ``out`` (5, D), for directions ``dx`` (5, D) of the state and ``seed`` (13, D)."""
    for i in range(STATES):
        for d in range(dx.shape[1]):
            out[i, d] = 0.0
        for j in range(STATES):
            if by_state[i, j] != 0.0:
                for d in range(dx.shape[1]):
                    out[i, d] += by_state[i, j] * dx[j, d]
        for j in range(PARAMETERS):
            if by_parameter[i, j] != 0.0:
                for d in range(dx.shape[1]):
                    out[i, d] += by_parameter[i, j] * seed[j, d]


@njit(cache=False)
def simulate(p, x0, u, h, seed, dx0, y, dy):
    """Motor speed into ``y`` (N,) and its derivatives into ``dy`` (N, D) along directions of the parameters ``seed`` (13, D) and of
    the start state ``dx0`` (5, D).
    """
    x, z, dx, dz = x0.copy(), x0.copy(), dx0.copy(), dx0.copy()
    k, dk, sum_k, sum_dk = np.empty(STATES), np.empty(dx.shape), np.empty(STATES), np.empty(dx.shape)
    by_state, by_parameter = np.zeros((STATES, STATES)), np.zeros((STATES, PARAMETERS))
    weights, nodes = (1.0, 2.0, 2.0, 1.0), (0.5, 0.5, 1.0, 0.0)
    for n in range(len(u)):
        y[n] = x[2]
        dy[n] = dx[2]
        z[:], dz[:] = x, dx
        sum_k[:], sum_dk[:] = 0.0, 0.0
        for stage in range(4):
            slopes(z, u[n], p, k, by_state, by_parameter)
            tangent(by_state, by_parameter, dz, seed, dk)
            w, c = weights[stage] * h / 6.0, nodes[stage] * h
            for i in range(STATES):
                sum_k[i] += w * k[i]
                z[i] = x[i] + c * k[i]
                for d in range(dx.shape[1]):
                    sum_dk[i, d] += w * dk[i, d]
                    dz[i, d] = dx[i, d] + c * dk[i, d]
        for i in range(STATES):
            x[i] += sum_k[i]
            for d in range(dx.shape[1]):
                dx[i, d] += sum_dk[i, d]


@njit(parallel=True, cache=False)
def sensitivities(p, x0, u, h, seed, dx0):
    """Speeds (E, N) and derivatives (E, N, D) of records on their own cores, for parameters (13,), start states (E, 5), torques."""
    y, dy = np.empty(u.shape), np.empty((*u.shape, seed.shape[1]))
    for e in prange(len(u)):
        simulate(p, x0[e], u[e], h, seed, dx0, y[e], dy[e])
    return y, dy
