"""The published estimation in JAX: Levenberg-Marquardt of optimistix, or written out, on a jitted scan.

`python -m experiments.speed.peers.jax_fit METHOD TORQUE_AND_SPEED.mat` is the small script of the fresh-process row: it reads the
recording, estimates, and prints the mean squared error.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from experiments.speed.peers import jax_arm

Estimate = Callable[..., tuple[Any, Any]]

STEP = 0.0005
"""Sample time, s."""

DOCUMENTED, LOOSE = 1e-8, 1e-4
"""Tolerances of optimistix: as in its documentation's example, and the loosest that was seen to reach the same optimum."""


def residuals(
    z: jax.Array, p: jax.Array, x0: jax.Array, u: jax.Array, y: jax.Array, free: jax.Array, states: jax.Array
) -> jax.Array:
    """Simulated minus measured speed (N,) with the unknowns ``z``: parameters ``free``, then start states ``states``."""
    count = len(free)
    return jax_arm.simulate(p.at[free].set(z[:count]), x0.at[states].set(z[count:]), u, STEP) - y


def with_optimistix(scale: np.ndarray, *, documented: bool = False) -> Estimate:
    """Jitted: start of the unknowns (10,) and the arguments of :func:`residuals` to the optimum and its mean squared error.

    The unknowns are estimated in units of ``scale``, since optimistix damps all alike. Unless as ``documented``, its settings are
    those that measured fastest: a loose tolerance, and normal equations by Cholesky in place of QR.
    """
    import lineax
    import optimistix

    tolerance = DOCUMENTED if documented else LOOSE
    linear = lineax.QR() if documented else lineax.Normal(lineax.Cholesky())
    solver = optimistix.LevenbergMarquardt(rtol=tolerance, atol=tolerance, linear_solver=linear)

    @jax.jit
    def estimate(z: jax.Array, *data: jax.Array) -> tuple[jax.Array, jax.Array]:
        found = optimistix.least_squares(
            lambda s, args: residuals(s * scale, *args), solver, z / scale, data, max_steps=200, throw=False
        )
        best = found.value * scale
        return best, jnp.mean(residuals(best, *data) ** 2)

    return lambda *arguments: jax.block_until_ready(estimate(*arguments))


def written_out(scale: np.ndarray) -> Estimate:
    """As :func:`with_optimistix`; the iteration in Python around one jitted function of cost, gradient and Hessian, as one would
    write it who knows that `jacfwd` of a scan is the costly part.
    """

    @jax.jit
    def matrices(s: jax.Array, *data: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        def both(t: jax.Array) -> tuple[jax.Array, jax.Array]:
            r = residuals(t * scale, *data)
            return r, r

        jacobian, r = jax.jacfwd(both, has_aux=True)(s)
        return jnp.mean(r**2), jacobian.T @ r, jacobian.T @ jacobian

    def estimate(z: np.ndarray, *data: jax.Array) -> tuple[np.ndarray, float]:
        s, damping = np.asarray(z) / scale, 1e-3
        cost, gradient, hessian = map(np.asarray, matrices(s, *data))
        for _ in range(60):
            trial = s - np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), gradient)
            there = list(map(np.asarray, matrices(trial, *data)))
            if there[0] < cost:
                change = (cost - there[0]) / cost
                s, (cost, gradient, hessian), damping = trial, there, damping / 10
                if change < 1e-9:
                    break
            else:
                damping *= 10
                if damping > 1e9:
                    break
        return s * scale, float(cost)

    return estimate


METHODS = {"optimistix": with_optimistix, "written out": written_out}


def main(method: str, recording: str) -> None:
    import scipy.io

    data = scipy.io.loadmat(recording)
    u, y = data["U"].ravel(), data["Y"].ravel()
    friction = [0.00986346744839, 0.74302635727901, 3.98628540790595, 3.24015074090438, 0.79943497008153]
    inertia = [0.03291699877416, 0.17910964111956, 0.61206166914114]
    springs = [20.59269827430799, 0.0, 0.06241814047290, 20.23072060978318, 0.00987527995798]
    p, x0 = np.array(friction + inertia + springs), np.array([0.0, 0.0, y[0], y[0], y[0]])
    free, states = np.arange(6, 13), np.arange(2, 5)
    start = np.concatenate([p[free], x0[states]])
    scale = np.where(start == 0.0, p[8], np.abs(start))
    best, mse = METHODS[method](scale)(start, p, x0, u, y, free, states)
    print(json.dumps({"mse": float(mse), "unknowns": np.asarray(best).tolist()}))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
