"""Whether the estimation experiments show enough to estimate a model from: times of the machine, and samples for what is unknown."""

from __future__ import annotations

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.estimate.problem import Problem

OF_A_TIME_CONSTANT = 0.05
"""Of a time constant below which an experiment is a straight line to it: what makes it up cannot be told apart."""

PER_UNKNOWN = 5
"""Measured values for each unknown, below which noise is fitted as well."""


def short_estimation(data: DataSet, constant: float | None) -> str | None:
    """A sentence without its full stop where the estimation experiments last a small part of the slowest time constant of the model, in s;
    else None.
    """
    longest = max((recording.seconds for recording in data.estimation()), default=0.0)
    if constant is None or not 0.0 < longest < OF_A_TIME_CONSTANT * constant:
        return None
    return (
        f"the longest estimation experiment lasts {longest:.4g} s, {100.0 * longest / constant:.2g} % of the slowest time constant, "
        f"{constant:.3g} s by the model's values: the parameters of that are hardly determined"
    )


def few_samples(problem: Problem) -> str | None:
    """Likewise where few values were measured for the parameters and start states to estimate."""
    measured = int(np.count_nonzero(np.isfinite(problem.records.y)))
    parameters, experiments = int(problem.free.sum()), len(problem.records.names)
    states = experiments * int(problem.initial_free.sum())
    if not parameters or measured >= PER_UNKNOWN * (parameters + states):
        return None
    of = " and ".join(
        f"{count} {what}{'s' * (count > 1)}"
        for count, what in ((parameters, "parameter"), (states, "start state"))
        if count
    )
    return f"{measured} measured values for {of} to estimate; expected {PER_UNKNOWN} for each at least"
