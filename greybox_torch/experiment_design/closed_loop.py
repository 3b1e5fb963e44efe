"""A machine under a digital controller, simulated: the inputs that reach it, of many set points side by side.

What a controller answers to a sample acts after it, so that the loop could be simulated sample by sample. Blocks of samples take far fewer
passes: the inputs of a block are guessed and the block is simulated; the next guess is what the controller answers, where outputs change
with the inputs as the machine's response to a short push says (a Newton iteration, with the response of an earlier block). Samples up
to which the guess is what the controller answers are settled, one at least in every second pass; the next block begins behind them.
Source: P. Deuflhard, "Newton Methods for Nonlinear Problems", 2004, ch. 2 (simplified Newton).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem
from greybox_torch.experiment_design.blocks import Machines
from greybox_torch.experiment_design.controller import Loop, Memory
from greybox_torch.simulation.simulator import Simulator

SHORTEST, LONGEST = 16, 128
"""Samples of a block, at least and at most. After one that is settled whole the next is longer, after one that hardly is, shorter."""
PATIENCE = 2
"""Blocks in a row of which little is settled before the response is measured again."""
SETTLED = 1e-9
"""Change of an input, as a share of the largest so far, that counts as none."""
PUSH = 1e-3
"""Change of an input that the response is measured with, as a share of the range of the loop."""


def under_feedback(
    problem: Problem,
    simulator: Simulator,
    loops: Sequence[Loop],
    values: np.ndarray,
    commands: Sequence[np.ndarray],
    step: float,
) -> list[np.ndarray]:
    """The inputs (n_u, N) that reach C machines; those mean nothing where a simulation is not finite.

    Args:
        values: parameters of each, (C, n_p).
        commands: for each, (n_u, N): the set point in the place of an input that a loop drives, other inputs as they are.
        step: the sample time, s.

    Raises:
        UserError: an output that a loop follows shows its input at once, and the loop has no delay.
    """
    machines = Machines(problem, simulator, values, step)
    references = np.stack(commands, axis=1)
    count, total = references.shape[1:]
    u, starts, response = references.copy(), None, None
    at, length, poor, settled = 0, SHORTEST, 0, 1
    memories, rows = [loop.begun(count) for loop in loops], [loop.driven for loop in loops]
    for loop in loops:
        u[loop.driven] = loop.rest
    while at < total:
        end, before = min(at + length, total), settled
        run = machines.run(u, at, end, starts)
        assert run.states is not None
        measured, given = run.y[:, : end - at, [loop.measured for loop in loops]], u[rows, :, at:end]
        if response is None or poor > PATIENCE:
            response, poor = _response(machines, loops, u, at, starts, measured), 0
        guess, followed = _answers(loops, memories, references, at, given, measured, response)
        settled = _settled(guess, given, u[rows, :, :end])
        if settled == before == 0:
            raise _at_once(problem, loops)
        u[rows, :, at + settled : end] = guess[:, :, settled:]
        u[rows, :, end:] = u[rows, :, end - 1 : end]  # the first guess of what follows
        if settled == end - at:
            length, poor = min(2 * length, LONGEST), 0
        elif 0 < settled < length // 4:
            length, poor = max(length // 2, SHORTEST), poor + 1
        if settled:
            starts = run.x_end if settled == end - at else run.states[:, settled]
            memories, at = followed[settled], at + settled
    return list(np.moveaxis(u, 1, 0))


def _answers(
    loops: Sequence[Loop],
    memories: list[Memory],
    references: np.ndarray,
    at: int,
    given: np.ndarray,
    measured: np.ndarray,
    response: np.ndarray,
) -> tuple[np.ndarray, list[list[Memory]]]:
    """The inputs (L, C, B) that L loops answer over a block, and their memories before every sample and after the last.

    Args:
        references: set points (n_u, C, N), of which the block begins at sample ``at``.
        given: the inputs (L, C, B) that gave the outputs ``measured`` (C, B, L).
        response: what a unit more of each input does to them later, (L inputs, C, samples, L outputs).
    """
    outputs, found, followed = measured.copy(), given.copy(), [memories]
    count = given.shape[2]
    for k in range(count):
        now = [
            loop.answer(memory, references[loop.driven, :, at + k], outputs[:, k, j])
            for j, (loop, memory) in enumerate(zip(loops, followed[-1], strict=True))
        ]
        followed.append([memory for _, memory in now])
        for j, (answer, _) in enumerate(now):
            found[j, :, k] = answer
            more = answer - given[j, :, k]
            if more.any():
                reach = min(count - k, response.shape[2])
                outputs[:, k + 1 : k + reach] += more[:, None, None] * response[j, :, 1:reach]
    return found, followed


def _response(
    machines: Machines, loops: Sequence[Loop], u: np.ndarray, at: int, starts: np.ndarray | None, measured: np.ndarray
) -> np.ndarray:
    """What the loops' outputs do, (L, C, samples, L), in answer to a push of every input that lasts one sample.

    Args:
        measured: the outputs (C, B, L) without it.
    """
    end = min(at + LONGEST, u.shape[2])
    plain = measured
    if measured.shape[1] < end - at:
        plain = machines.run(u, at, end, starts).y[:, : end - at, [loop.measured for loop in loops]]
    found = []
    for loop in loops:
        size = PUSH * max(np.nan_to_num(loop.upper - loop.lower, posinf=1.0), 1e-9)
        pushed = u.copy()
        pushed[loop.driven, :, at] += size
        y = machines.run(pushed, at, end, starts).y[:, : end - at, [one.measured for one in loops]]
        with np.errstate(invalid="ignore", over="ignore"):
            found.append(np.nan_to_num((y - plain) / size, posinf=0.0, neginf=0.0))
    return np.array(found)


def _settled(found: np.ndarray, given: np.ndarray, so_far: np.ndarray) -> int:
    """How many samples have the inputs that the controller answers, on every machine: (L, C, B) both, and all so far (L, C, n)."""
    size = np.abs(so_far).max(axis=2, keepdims=True, initial=0.0, where=np.isfinite(so_far))
    other = ~((np.abs(found - given) <= SETTLED * size) | (np.isnan(found) & np.isnan(given))).all(axis=(0, 1))
    return int(np.argmax(other)) if other.any() else len(other)


def _at_once(problem: Problem, loops: Sequence[Loop]) -> UserError:
    inputs, outputs = problem.model.inputs, problem.model.outputs
    which = " and ".join(f"{inputs[one.driven].name} (by {outputs[one.measured].name})" for one in loops)
    return UserError(
        f"[controller] {which}: the output shows the input of the same sample, so that a loop without delay has no simulation; "
        "expected delay = 1 or more"
    )
