"""The arm in JAX: `lax.scan` over Runge-Kutta steps, as JAX's users write a fixed-step simulation."""

from __future__ import annotations

from collections.abc import Callable

import jax

jax.config.update("jax_enable_x64", True)  # before any array is made

import jax.numpy as jnp  # noqa: E402


def rates(x: jax.Array, torque: jax.Array, p: tuple) -> jax.Array:
    """dx/dt (5,), equations (1)-(5) of Wernholt and Gunnarsson (2006), parameters (13,) in the order of the model."""
    gear_twist, arm_twist, motor, gearbox, arm = tuple(x)
    f_v, f_c, f_cs, alpha, beta, inertia, a_m, a_g, k_g1, k_g3, d_g, k_a, d_a = p
    stribeck = f_cs / jnp.cosh(jnp.clip(alpha * motor, -80.0, 80.0))
    friction = f_v * motor + (f_c + stribeck) * jnp.tanh(beta * motor)
    gear = k_g1 * gear_twist + k_g3 * gear_twist * gear_twist * gear_twist + d_g * (motor - gearbox)
    spring = k_a * arm_twist + d_a * (gearbox - arm)
    return jnp.stack(
        [
            motor - gearbox,
            gearbox - arm,
            (torque - friction - gear) / (inertia * a_m),
            (gear - spring) / (inertia * a_g),
            spring / (inertia * (1 - a_m - a_g)),
        ]
    )


def simulate(p: jax.Array, x0: jax.Array, u: jax.Array, h: float) -> jax.Array:
    """Motor speed (N,) at the samples, for parameters (13,), start state (5,), torque (N,) held over each sample of ``h`` s.

    The state is one array: with a tuple of scalars in its place the run of one record measured four times slower.
    """
    parameters = tuple(p)

    def step(x: jax.Array, torque: jax.Array) -> tuple[jax.Array, jax.Array]:
        k1 = rates(x, torque, parameters)
        k2 = rates(x + 0.5 * h * k1, torque, parameters)
        k3 = rates(x + 0.5 * h * k2, torque, parameters)
        k4 = rates(x + h * k3, torque, parameters)
        return x + h / 6 * (k1 + 2 * (k2 + k3) + k4), x[2]

    return jax.lax.scan(step, x0, u)[1]


def free_run(h: float) -> Callable[..., jax.Array]:
    """Jitted: parameters (13,), start states (E, 5), torque (E, N) to speeds (E, N)."""
    return jax.jit(jax.vmap(lambda p, x0, u: simulate(p, x0, u, h), in_axes=(None, 0, 0)))


def free_run_in_turn(h: float) -> Callable[..., jax.Array]:
    """As :func:`free_run`, one record after the other inside the compiled program (`lax.map`)."""
    return jax.jit(lambda p, x0, u: jax.lax.map(lambda record: simulate(p, *record, h), (x0, u)))


def sensitivities(h: float, index: tuple[int, ...]) -> Callable[..., tuple[jax.Array, jax.Array]]:
    """Jitted: as :func:`free_run`, to speeds (E, N) and their derivatives (E, N, n) to the parameters ``index``, by `jax.jacfwd`."""
    where = jnp.array(index)

    def both(p: jax.Array, x0: jax.Array, u: jax.Array) -> tuple[jax.Array, jax.Array]:
        def speeds(some: jax.Array) -> tuple[jax.Array, jax.Array]:
            y = simulate(p.at[where].set(some), x0, u, h)
            return y, y

        derivative, y = jax.jacfwd(speeds, has_aux=True)(p[where])
        return y, derivative

    return jax.jit(jax.vmap(both, in_axes=(None, 0, 0)))


def normal_matrix(h: float, index: tuple[int, ...]) -> Callable[..., jax.Array]:
    """Jitted: parameters, start state (5,), torque (N,), measured speed (N,) to the matrix [J e]ᵀ[J e] (n + 1, n + 1)."""
    where = jnp.array(index)

    def matrix(p: jax.Array, x0: jax.Array, u: jax.Array, measured: jax.Array) -> jax.Array:
        def speeds(some: jax.Array) -> tuple[jax.Array, jax.Array]:
            y = simulate(p.at[where].set(some), x0, u, h)
            return y, y

        derivative, y = jax.jacfwd(speeds, has_aux=True)(p[where])
        rows = jnp.concatenate([derivative, (measured - y)[:, None]], axis=1)
        return rows.T @ rows

    return jax.jit(matrix)
