"""A hypothesis on whole records, begun where its windows led to."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, without_free
from greybox_torch.estimate.coloured_run import Coloured, fit_coloured
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.side_by_side import side_by_side


def whole_runs(hypothesis: Hypothesis, problems: Sequence[Problem]) -> list[FreeRun]:
    """Free runs of whole records at ``problems``, which are the hypothesis's but for the values of parameters and start states.

    The heights of free curves stay as the windows have them, where they are held small: what the records do not determine must not
    run away.
    """
    shrunk = [p.name for p in hypothesis.model.declared_parameters if p.shrunk]
    simulator = hypothesis.simulator
    if shrunk:
        own = [n for n in hypothesis.problem.free_names if n not in shrunk]
        simulator = simulator.for_model(hypothesis.model, own)
    return [FreeRun(without_free(p, shrunk), simulator) for p in problems]


def coloured(runs: Sequence[FreeRun]) -> tuple[FreeRun, Coloured] | None:
    """The likeliest fit with coloured errors, of one hypothesis begun in several ways; None where none can be simulated."""
    fits = side_by_side(partial(fit_coloured, run, run.start) for run in runs)
    found = [(run, fit) for run, fit in zip(runs, fits, strict=True) if fit is not None]
    return min(found, key=lambda pair: pair[1].cost, default=None)
