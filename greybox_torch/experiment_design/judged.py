"""An input judged as a recording of it will be: every rival estimated anew, whichever parameters the right hypothesis has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.experiment_design.aim import Aim, Trial
from greybox_torch.experiment_design.contender import Contender, driven_under
from greybox_torch.experiment_design.imitation import QUICK, Effort, not_imitated
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.experiment_design.simulated import input_records, keeps

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
    found = [_nats(aim, *own, time, effort) for own in list(zip(draws, inputs, strict=True))[: 1 + DRAWS]]
    nats = np.expm1(np.mean([np.log1p(n) for n in found], axis=0))
    fine = all(_all_keep(own, limits, u, time) for own, u in list(zip(draws, inputs, strict=True))[1:])
    score = float(np.mean([aim.decided(n) for n in found])) - (0.0 if fine else OUTSIDE)
    return replace(trial, nats=nats, score=score)


def _inputs(draws: Draws, trial: Trial, time: np.ndarray) -> list[list[np.ndarray]]:
    """For each draw the inputs (n_u, N) that reach the machine under each of its hypotheses."""
    step = float(time[1] - time[0])
    by_hypothesis = [driven_under(own, [trial.commands] * len(draws), step) for own in zip(*draws, strict=True)]
    return [list(own) for own in zip(*by_hypothesis, strict=True)]


def _all_keep(draw: Sequence[Contender], limits: Limits, inputs: Sequence[np.ndarray], time: np.ndarray) -> bool:
    return all(keeps(one, limits, [u], time)[0] for one, u in zip(draw, inputs, strict=True))


def _nats(
    aim: Aim, rights: Sequence[Contender], inputs: Sequence[np.ndarray], time: np.ndarray, effort: Effort
) -> np.ndarray:
    """The evidence (n, n) for each hypothesis with these parameters, on the input that reaches the machine then, against each other one."""
    count = len(aim.contenders)
    found = np.zeros((count, count))
    pairs = list(zip(rights, inputs, strict=True))
    outputs = [one.predicted(input_records(one, [u], time), tangents=False).y[0] for one, u in pairs]
    for b, rival in enumerate(aim.contenders):
        records, first = None, None
        for a, own in enumerate(outputs):
            if a == b or not np.isfinite(own).all():
                continue
            if records is None or first is None or rights[a].loops:
                records = input_records(rival, [inputs[a]], time)
                first = rival.predicted(records)
            found[a, b] = not_imitated(own, rival, first, records, aim.level, effort)
    return found
