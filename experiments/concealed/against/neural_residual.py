"""A neural residual: it closes what it can, and names nothing.

The network acts at every body and sees all states and inputs (:mod:`.network`). It is trained by Levenberg-Marquardt on the errors of
windows with free start states, short ones first, on the first part of the estimation experiments; training stops, window length by window
length, where the last part no longer gains. Of what each length led to, the plain model among them, and of the widths the best on long
windows of the last part is taken. The plain model's parameters move along. What is judged is
the free run, in which a network leaves the region that it has seen more easily than a law does.

Source: J. Sjöberg et al., "Nonlinear black-box modeling in system identification: a unified overview", Automatica 31(12), 1995 (for the
early stopping); C. Rackauckas et al., "Universal differential equations for scientific machine learning", arXiv 2001.04385, 2020.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from experiments.concealed.against.judge import Answer
from experiments.concealed.against.network import NetworkModel, network_model
from experiments.concealed.against.plain import CHOSEN_ON, Plain
from greybox_torch.diagnosis.hypothesis import window_lengths
from greybox_torch.estimate import Problem, Settings, fit_windows, problem_for
from greybox_torch.simulation import Simulator

WIDTHS = (6, 12)
"""Hidden units tried."""

STAGE = Settings(iterations=6, tolerance=1e-3, trials=6)
"""Training between two looks at the held-out part."""

MOST_STAGES = 5
"""Looks at one window length."""

PATIENCE = 2
"""Looks without a gain after which training goes on at the next window length, from the best so far."""

REST = Settings(iterations=12, tolerance=1e-3, trials=5)


@dataclass(frozen=True)
class Trained:
    """A network with its weights in ``problem``; ``left`` is the mean squared held-out error over long windows, nearly a free run."""

    width: int
    model: NetworkModel
    problem: Problem
    left: float


def neural_residual(plain: Plain, *, widths: Sequence[int] = WIDTHS, seed: int = 0) -> Answer:
    """The answer of the network that predicts the last part of the estimation experiments best; it names nothing."""
    trained = [_trained(plain, width, seed) for width in widths]
    best = min(trained, key=lambda t: t.left)
    notes = {"held_out": {str(t.width): t.left for t in trained}, "width": best.width}
    values = best.problem.values_by_name
    return Answer(best.model, values, None, notes)


def _trained(plain: Plain, width: int, seed: int) -> Trained:
    model = network_model(plain.problem, plain.simulator, width, seed=seed)
    problem = problem_for(plain.problem, model, {})
    simulator = plain.simulator.for_model(model, problem.free_names)
    first, last = _parts(problem)
    longest = window_lengths(plain.problem)[-1]
    reached = [problem]
    for length in window_lengths(plain.problem):
        reached.append(_at_length(first, last, reached[-1], simulator, length))
    errors = [_left(last.with_values(p.values), simulator, longest) for p in reached]
    best = int(np.argmin(errors))
    return Trained(width, model, reached[best], errors[best])


def _at_length(first: Problem, last: Problem, problem: Problem, simulator: Simulator, length: int) -> Problem:
    """``problem`` trained on windows of one length, with the weights that did best on the last part; as it is where none did better."""
    best, least, patience = problem, _left(last.with_values(problem.values), simulator, length), PATIENCE
    begin, starts = first.with_values(problem.values), None
    for _ in range(MOST_STAGES):
        fit = fit_windows(begin, simulator, length, starts=starts, settings=STAGE)
        if fit is None:
            break
        begin, starts = fit.problem, fit.starts
        left = _left(last.with_values(begin.values), simulator, length)
        if left < least:
            best, least, patience = problem.with_values(begin.values), left, PATIENCE
        else:
            patience -= 1
        if not patience:
            break
    return best


def _parts(problem: Problem) -> tuple[Problem, Problem]:
    """The first part of the estimation experiments and the last."""
    records = problem.records
    cuts = [int(f) + int((1.0 - CHOSEN_ON) * n) for f, n in zip(records.first, records.lengths, strict=True)]
    first = [slice(int(f), c) for f, c in zip(records.first, cuts, strict=True)]
    last = [slice(c, int(end) + 1) for c, end in zip(cuts, records.last, strict=True)]
    return tuple(replace(problem, records=records.part(spans, records.names)) for spans in (first, last))  # type: ignore[return-value]


def _left(last: Problem, simulator: Simulator, length: int) -> float:
    """Mean squared error over windows of the last part, their start states free, everything else as it is."""
    rest = replace(last, free=np.zeros_like(last.free))
    fit = fit_windows(rest, simulator, length, settings=REST)
    return float("inf") if fit is None else fit.mean_square
