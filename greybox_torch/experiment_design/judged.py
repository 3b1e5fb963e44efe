"""An input judged as a recording of it will be: every rival estimated anew, whichever parameters the right hypothesis has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.experiment_design.aim import Aim, Trial
from greybox_torch.experiment_design.contender import Contender, driven_under
from greybox_torch.experiment_design.imitation import QUICK, Effort, not_imitated
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.experiment_design.simulated import chunks, input_records, keeps
from greybox_torch.simulation.side_by_side import side_by_side

DRAWS = 2
"""Draws of every hypothesis' parameters from what is known of them, beside its estimates, under which an input is judged."""
SAFE = 20
"""Draws under which an input should keep the limits: of what keeps them in all, one machine in seven leaves them at most (95 %)."""
OUTSIDE = 1.0
"""What an input loses that keeps the limits at the estimates and not at a draw: it is taken where there is no other."""

Draws = Sequence[Sequence[Contender]]


def draws_of(aim: Aim, seed: int) -> Draws:
    """The hypotheses at their estimates, and at draws of their parameters, the same for every input."""
    rng = np.random.default_rng(seed)
    return [aim.contenders, *(tuple(c.drawn(rng) for c in aim.contenders) for _ in range(SAFE))]


def judged(aim: Aim, draws: Draws, trial: Trial, time: np.ndarray, limits: Limits, effort: Effort = QUICK) -> Trial:
    """The trial with its evidence, typical of the draws (the mean of its logarithm), and its score by that."""
    inputs = _inputs(draws, trial, time)
    found = _nats(aim, draws[: 1 + DRAWS], inputs[: 1 + DRAWS], time, effort)
    nats = np.expm1(np.mean([np.log1p(n) for n in found], axis=0))
    fine = all(_all_keep(draws[1:], inputs[1:], limits, time, h) for h in range(len(draws[0]))) if draws[1:] else True
    score = float(np.mean([aim.decided(n) for n in found])) - (0.0 if fine else OUTSIDE)
    return replace(trial, nats=nats, score=score)


def judged_at_estimates(aim: Aim, trials: Sequence[Trial], time: np.ndarray, effort: Effort = QUICK) -> list[Trial]:
    """Trials with their evidence and scores at the hypotheses' own estimates alone, side by side."""
    step = float(time[1] - time[0])
    reached = [one.driven([trial.commands for trial in trials], step) for one in aim.contenders]
    inputs = [list(own) for own in zip(*reached, strict=True)]
    found = _nats(aim, [aim.contenders] * len(trials), inputs, time, effort)
    return [replace(t, nats=n, score=aim.decided(n)) for t, n in zip(trials, found, strict=True)]


def _inputs(draws: Draws, trial: Trial, time: np.ndarray) -> list[list[np.ndarray]]:
    """For each draw the inputs (n_u, N) that reach the machine under each of its hypotheses."""
    step = float(time[1] - time[0])
    by_hypothesis = [driven_under(own, [trial.commands] * len(draws), step) for own in zip(*draws, strict=True)]
    return [list(own) for own in zip(*by_hypothesis, strict=True)]


def _all_keep(
    draws: Draws, inputs: Sequence[Sequence[np.ndarray]], limits: Limits, time: np.ndarray, hypothesis: int
) -> bool:
    """Whether a hypothesis keeps the limits with the parameters of every draw, simulated side by side."""
    own, values = [u[hypothesis] for u in inputs], np.array([draw[hypothesis].problem.values for draw in draws])
    one = draws[0][hypothesis]
    size = len(time) * (len(one.level) + len(one.problem.model.states))
    return all(keeps(one, limits, own[c], time, values[c]).all() for c in chunks(len(own), size))


def _nats(
    aim: Aim, draws: Draws, inputs: Sequence[Sequence[np.ndarray]], time: np.ndarray, effort: Effort
) -> list[np.ndarray]:
    """For each draw the evidence (n, n) for each hypothesis with these parameters against each other one, on the input that reaches the
    machine then.
    """
    count, found = len(aim.contenders), [np.zeros((len(aim.contenders),) * 2) for _ in draws]
    outputs = []  # by hypothesis and draw
    for a, one in enumerate(aim.contenders):
        values = np.array([draw[a].problem.values for draw in draws])
        records = input_records(one, [u[a] for u in inputs], time)
        outputs.append(one.predicted(records, tangents=False, values=values).y)

    def against(b: int) -> None:
        rival = aim.contenders[b]
        lanes = [(d, a) for d in range(len(draws)) for a in range(count) if a != b and np.isfinite(outputs[a][d]).all()]
        if not lanes:
            return
        records = input_records(rival, [inputs[d][a] for d, a in lanes], time)
        nats = not_imitated([outputs[a][d] for d, a in lanes], rival, records, aim.level, effort)
        for (d, a), value in zip(lanes, nats, strict=True):
            found[d][a, b] = value

    side_by_side([partial(against, b) for b in range(count)])
    return found
