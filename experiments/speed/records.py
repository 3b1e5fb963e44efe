"""The arm that is measured on: its numbers, simulated records of it, and the published estimation problem."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from greybox_torch import load_dataset, load_model
from greybox_torch.estimate import Problem, make_problem
from greybox_torch.simulation import Pass, Records, Simulator, whole_records
from greybox_torch.systems import RobotArm

SAMPLE_TIME = 0.0005
"""s, as in the published recordings."""

SAMPLES = 19838
"""Samples of a published recording."""

OPTIMUM = {
    "a_m": 0.26631,
    "a_g": 0.65080,
    "k_g1": 19.985,
    "k_g3": 24.265,
    "d_g": 0.030811,
    "k_a": 11.407,
    "d_a": 0.0025888,
}
"""About the optimum on the published estimation experiment, so that every term of the equations is at work."""

NAMES = tuple(p.name for p in RobotArm().declared_parameters)
"""The arm's 13 parameters, in the order in which every peer takes them."""

SENSITIVE = tuple(name for name in NAMES if name != "J")
"""The 12 parameters that sensitivities are asked for."""

SENSITIVE_INDEX = tuple(NAMES.index(name) for name in SENSITIVE)

TRUE_STARTS = np.array([0.0, 0.0, -19.0, -22.3, -23.3])
"""Start state of every simulated record: twists in rad, speeds in rad/s."""


def arm_values() -> np.ndarray:
    """The arm's parameters (13,) near the optimum."""
    return np.array([OPTIMUM.get(p.name, p.value) for p in RobotArm().declared_parameters])


def torque(samples: int, seed: int) -> np.ndarray:
    """A torque (N,) in N m that keeps the arm moving in both directions: a square wave and five sines, phases drawn with ``seed``."""
    rng = np.random.default_rng(seed)
    t = SAMPLE_TIME * np.arange(samples)
    result = 6.0 * np.sign(np.sin(4.0 * t + rng.uniform(0, 2 * np.pi)))
    for frequency in (3.1, 7.3, 11.7, 19.1, 29.3):
        result += 1.5 * np.sin(2 * np.pi * frequency * t + rng.uniform(0, 2 * np.pi))
    return result


def simulated_records(experiments: int, samples: int, *, noise: float = 1.0, seed: int = 0) -> Records:
    """``experiments`` records of ``samples`` samples end to end; the measured speed is the simulated one with ``noise`` in rad/s."""
    u = np.concatenate([torque(samples, seed + e) for e in range(experiments)])[None]
    first = samples * np.arange(experiments)
    silent = Records(
        u=u,
        y=np.zeros_like(u),
        dt=np.full(u.shape[1], SAMPLE_TIME),
        first=first,
        last=first + samples - 1,
        names=tuple(f"record {e + 1}" for e in range(experiments)),
        hold="zoh",
    )
    run = Simulator.of(RobotArm(), ()).run(silent, Pass(whole_records(silent), arm_values(), starts(experiments)))
    y = run.y[..., 0].reshape(1, -1) + np.random.default_rng(seed + 1000).normal(0.0, noise, u.shape)
    return replace(silent, y=y)


def starts(experiments: int) -> np.ndarray:
    """Start states (E, 5) of the simulated records."""
    return np.tile(TRUE_STARTS, (experiments, 1))


def simulated_problem(experiments: int, samples: int) -> Problem:
    """Simulated records with the arm's 12 parameters free, at their true values."""
    model, records = RobotArm(), simulated_records(experiments, samples)
    bounds = [p.bounds for p in model.declared_parameters]
    return Problem(
        model=model,
        records=records,
        names=tuple(p.name for p in model.declared_parameters),
        values=arm_values(),
        lower=np.array([b[0] for b in bounds]),
        upper=np.array([b[1] for b in bounds]),
        free=np.array([p.name in SENSITIVE for p in model.declared_parameters]),
        initial=starts(experiments),
        initial_free=np.ones(5, dtype=bool),
        weights=np.ones(1),
        carried=np.zeros(5, dtype=bool),
        expected=arm_values(),
    )


@dataclass(frozen=True)
class Published:
    """The published estimation as numbers that any tool can take: torque ``u`` (N,) in N m, measured speed ``y`` (N,) in rad/s.

    ``p`` (13,) are all parameters and ``x0`` (5,) the start state; the unknowns z are ``p[free]`` and then ``x0[free_states]``, and
    each is of the size ``scale``.
    """

    u: np.ndarray
    y: np.ndarray
    p: np.ndarray
    x0: np.ndarray
    free: np.ndarray
    free_states: np.ndarray
    scale: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    @property
    def start(self) -> np.ndarray:
        return np.concatenate([self.p[self.free], self.x0[self.free_states]])

    def at(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Parameters (13,) and start state (5,) at unknowns ``z``."""
        p, x0 = self.p.copy(), self.x0.copy()
        p[self.free], x0[self.free_states] = z[: len(self.free)], z[len(self.free) :]
        return p, x0

    def shortened(self, samples: int) -> Published:
        return replace(self, u=self.u[:samples], y=self.y[:samples])


def load_problem(card: Path) -> Problem:
    """The estimation problem of a card."""
    data = load_dataset(card)
    return make_problem(data, load_model(data.model or "robot_arm"), data.estimation())


def published(problem: Problem) -> Published:
    """``problem``, which has one experiment, as plain numbers."""
    free, free_states = np.flatnonzero(problem.free), problem.free_states
    start = np.concatenate([problem.values[free], problem.initial[0, free_states]])
    stiffness = problem.values[problem.names.index("k_g1")]  # the size of k_g3, which begins at zero
    unbounded = np.full(len(free_states), np.inf)
    return Published(
        u=problem.records.u[0],
        y=problem.records.y[0],
        p=problem.values,
        x0=problem.initial[0],
        free=free,
        free_states=free_states,
        scale=np.where(start == 0.0, stiffness, np.abs(start)),
        lower=np.concatenate([problem.lower[free], -unbounded]),
        upper=np.concatenate([problem.upper[free], unbounded]),
    )
