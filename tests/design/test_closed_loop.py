"""A machine under feedback, simulated in blocks: against closed forms, and against loops run sample by sample."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem
from greybox_torch.experiment_design import closed_loop
from greybox_torch.experiment_design.controller import Loop
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Output
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows
from tests.machines.motor import Motor
from tests.mechanisms.attaching import at, attached, values_of

STEP, J, K, B = 0.01, 0.01, 0.1, 0.1
POLE = np.exp(-B / J * STEP)
FORWARD = K / B * (1.0 - POLE)  # the sampled machine: y[k+1] = POLE y[k] + FORWARD u[k]


def problem_of(model: Any, starts: list[float]) -> Problem:
    """A problem of one recording, of which only its start states and values count."""
    numbers = np.array([p.value for p in model.declared_parameters])
    still = np.zeros(4)
    records = Records(
        np.zeros((len(model.plain.inputs), 4)), np.zeros((len(model.outputs), 4)), STEP + still,
        np.array([0]), np.array([3]), ("first",), "zoh",
    )  # fmt: skip
    free = np.zeros(len(numbers), dtype=bool)
    none = np.zeros(len(model.states), dtype=bool)
    names_of = tuple(p.name for p in model.declared_parameters)
    return Problem(
        model, records, names_of, numbers, numbers - 1, numbers + 1, free, np.array([starts]), none,
        np.ones(len(model.outputs)), none, numbers,
    )  # fmt: skip


def under(
    problem: Problem, loop: Loop, reference: np.ndarray, values: np.ndarray | None = None, *, substeps: int = 8
) -> np.ndarray:
    """The inputs (C, N) on set points (C, N)."""
    simulator = Simulator.of(problem.model).with_substeps(substeps)
    rows = np.repeat(problem.values[None], len(reference), axis=0) if values is None else values
    found = closed_loop.under_feedback(problem, simulator, [loop], rows, [r[None] for r in reference], STEP)
    return np.array(found)[:, 0]


SETS = np.array([np.repeat([1.0, -0.5, 2.0], 100), np.sin(0.05 * np.arange(300)), np.zeros(300)])
AROUND = Surroundings({"speed": Range(-3.0, 3.0, 1.5), "input": Range(-3.0, 3.0, 1.5)}, {}, "N m", STEP)
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


def one_by_one(problem: Problem, values: np.ndarray, loop: Loop, reference: np.ndarray) -> np.ndarray:
    """The inputs (N,) of a loop that is run sample by sample, in plain torch operations; the law is written out here anew."""
    stepper = EagerStepper.of(problem.model, (), "cpu", "double")
    count, total, before = len(reference), 0.0, None
    u, x, waiting = np.zeros(count), problem.initial, [loop.offset] * loop.delay
    steps, last = np.full(count, STEP), np.array([count - 1])
    for k in range(count):
        y = x[0, 0]  # the speed is measured
        slope = 0.0 if before is None else (y - before) / STEP
        free = loop.offset + loop.gain * (reference[k] - y + total - loop.derivative * slope)
        waiting.append(min(max(free, loop.lower), loop.upper))
        further = (free > loop.upper and reference[k] > y) or (free < loop.lower and reference[k] < y)
        total, before = total + (0.0 if further else loop.integral * STEP * (reference[k] - y)), y
        u[k:] = waiting.pop(0)
        records = Records(u[None].copy(), np.zeros((1, count)), steps, np.array([0]), last, ("",), "zoh")
        asked = Pass(Windows(np.array([k]), last, 1), values, x)
        x = stepper.run(problem.model.prepared(records, values), asked).x_end
    return u


TIGHT = {"driven": 0, "measured": 0, "lower": -1.2, "upper": 1.5, "step": STEP}


@pytest.mark.parametrize(
    "loop",
    [
        Loop(**TIGHT, gain=3.0, integral=8.0),
        Loop(**TIGHT, gain=2.0, integral=5.0, derivative=0.004, offset=0.2),
        Loop(**TIGHT, gain=0.6, integral=5.0, offset=0.2, delay=2),
    ],
    ids=["clipped", "derivative", "delayed"],
)
def test_sample_by_sample(loop: Loop) -> None:
    """Dry friction and an input that acts 1.7 or 2.4 samples late: every machine with parameters of its own, inputs clipped, all terms."""
    model = attached(Motor(), AROUND, at("rotor", CoulombFriction()), at("actuator", InputDelay()))
    values = np.array([values_of(model, F_c=0.05, v_0=0.05, T=0.017), values_of(model, F_c=0.02, v_0=0.1, T=0.024)])
    reference = np.array([np.repeat([1.0, -0.5, 2.0], 15), np.repeat([0.2, 3.0, -1.0], 15)])
    found = under(problem_of(model, [0.3]), loop, reference, values, substeps=1)
    for u, p, r in zip(found, values, reference, strict=True):
        np.testing.assert_allclose(u, one_by_one(problem_of(model, [0.3]), p, loop, r), rtol=0, atol=1e-7)
    assert (found == loop.upper).any() and (found == loop.lower).any()


def slowly(problem: Problem, loop: Loop, reference: np.ndarray) -> np.ndarray:
    """:func:`under` without a compiler."""
    simulator = Simulator(EagerStepper.of(problem.model, (), "cpu", "double"))
    rows = np.repeat(problem.values[None], len(reference), axis=0)
    return np.array(closed_loop.under_feedback(problem, simulator, [loop], rows, [r[None] for r in reference], STEP))[
        :, 0
    ]


class Unstable(Motor):
    """The motor with a force that drives it on."""

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (p.k * u.voltage + p.b * x.speed + 0.3 * x.speed**3) / p.J}


def test_an_unstable_machine_is_held_whatever_another_one_does() -> None:
    problem = problem_of(Unstable(), [0.3])
    loop = Loop(0, 0, -3.0, 3.0, STEP, gain=5.0, integral=1.0)
    held = slowly(problem, loop, 0.3 * SETS[:1, :40])
    assert np.isfinite(held).all() and 0.0 < np.abs(held).max() < 3.0
    both = slowly(problem, loop, np.array([0.3, 40.0])[:, None] * SETS[:1, :40])
    np.testing.assert_allclose(both[0], held[0], atol=1e-8)


class Shown(Motor):
    """The motor, of which the acceleration is measured."""

    outputs = [Output("acceleration", "rad/s^2")]

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"acceleration": (p.k * u.voltage - p.b * x.speed) / p.J}


def test_an_output_that_shows_the_input_at_once_needs_a_delay() -> None:
    problem = problem_of(Shown(), [0.0])
    with pytest.raises(UserError, match=r"\[controller\] voltage \(by acceleration\): .* expected delay = 1"):
        slowly(problem, Loop(**FREE, gain=2.0), SETS[:1, :6])
    assert np.isfinite(slowly(problem, Loop(**FREE, gain=0.01, delay=1), SETS[:1, :6])).all()


def test_few_passes(monkeypatch) -> None:
    """Blocks, not samples."""
    passes: list[int] = []
    run = Simulator.run
    monkeypatch.setattr(Simulator, "run", lambda self, *asked: passes.append(1) or run(self, *asked))
    under(problem_of(Motor(), [0.0]), Loop(**FREE, gain=2.0, integral=10.0), SETS)
    assert len(passes) < 0.1 * SETS.shape[1]
