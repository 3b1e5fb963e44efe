"""A machine under feedback, simulated in blocks: against closed forms, and against loops run sample by sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from greybox_torch.api.design import _contender
from greybox_torch.api.hypotheses import hypotheses_of
from greybox_torch.errors import UserError
from greybox_torch.experiment_design import closed_loop
from greybox_torch.experiment_design.contender import Contender, driven_under
from greybox_torch.experiment_design.controller import Loop
from greybox_torch.model import Output
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.estimate.problem import Problem
from tests.machines.motor import Motor

STEP, J, K, B = 0.01, 0.01, 0.1, 0.1
POLE = np.exp(-B / J * STEP)
FORWARD = K / B * (1.0 - POLE)  # the sampled machine: y[k+1] = POLE y[k] + FORWARD u[k]


def problem_of(
    model, starts: list[float], values: list[float] | None = None, names: list[str] | None = None
) -> Problem:
    """A problem of one recording, of which only its start states and values count."""
    numbers = np.array([p.value for p in model.declared_parameters])
    still = np.zeros(4)
    records = Records(
        np.zeros((len(model.inputs), 4)), np.zeros((len(model.outputs), 4)), STEP + still,
        np.array([0]), np.array([3]), ("first",), "zoh",
    )  # fmt: skip
    free = np.zeros(len(numbers), dtype=bool)
    none = np.zeros(len(model.states), dtype=bool)
    names_of = tuple(p.name for p in model.declared_parameters)
    return Problem(
        model, records, names_of, numbers, numbers - 1, numbers + 1, free, np.array([starts]), none,
        np.ones(len(model.outputs)), none, numbers,
    )  # fmt: skip


def under(problem: Problem, loop: Loop, reference: np.ndarray, values: np.ndarray | None = None) -> np.ndarray:
    """The inputs (C, N) on set points (C, N)."""
    simulator = Simulator.of(problem.model).with_substeps(8)
    rows = np.repeat(problem.values[None], len(reference), axis=0) if values is None else values
    found = closed_loop.under_feedback(problem, simulator, [loop], rows, [r[None] for r in reference], STEP)
    return np.array(found)[:, 0]


def outputs(problem: Problem, u: np.ndarray) -> np.ndarray:
    """The outputs (C, N) of the sampled motor on inputs (C, N), by its closed form."""
    start = problem.initial[0, 0]
    return np.array(
        [lfilter([0.0, FORWARD], [1.0, -POLE], row, zi=[start * 1.0])[0] if False else _run(row, start) for row in u]
    )


def _run(u: np.ndarray, y: float) -> np.ndarray:
    found = []
    for v in u:
        found.append(y)
        y = POLE * y + FORWARD * v
    return np.array(found)


SETS = np.array([np.repeat([1.0, -0.5, 2.0], 100), np.sin(0.05 * np.arange(300)), np.zeros(300)])
FREE = {"driven": 0, "measured": 0, "lower": -1e6, "upper": 1e6, "step": STEP}


def test_proportional() -> None:
    """y[k+1] = (POLE − FORWARD K) y[k] + FORWARD K r[k]."""
    problem = problem_of(Motor(), [0.3])
    u = under(problem, Loop(**FREE, gain=2.0), SETS)
    pole = POLE - 2.0 * FORWARD
    for row, r in zip(u, SETS, strict=True):
        own = lfilter([0.0, 2.0 * FORWARD], [1.0, -pole], r) + 0.3 * pole ** np.arange(300)
        np.testing.assert_allclose(row, 2.0 * (r - own), rtol=0, atol=1e-6)


def test_proportional_and_integral() -> None:
    """The transfer function of the sampled loop, from rest."""
    gain, integral = 2.0, 10.0
    u = under(problem_of(Motor(), [0.0]), Loop(**FREE, gain=gain, integral=integral), SETS)
    # the law (gain (z − 1 + integral T)) / (z − 1) by the machine FORWARD / (z − POLE)
    law, plant = gain * np.array([1.0, integral * STEP - 1.0]), np.array([1.0, -POLE])
    closed = np.polymul(plant, [1.0, -1.0]) + np.concatenate([[0.0], FORWARD * law])
    for row, r in zip(u, SETS, strict=True):
        np.testing.assert_allclose(row, lfilter(np.polymul(law, plant), closed, r), rtol=0, atol=1e-6)
