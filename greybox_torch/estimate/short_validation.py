"""Whether the validation experiments last long enough to judge a model by, beside those of estimation and the times of the machine."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import torch

from greybox_torch.data import DataSet
from greybox_torch.estimate.problem import Problem
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.signals import parameter_signals

SMALL = 0.02
"""Share of the time of the estimation experiments below which validation experiments are told to be short, whatever the machine."""

OF_A_TIME_CONSTANT = 0.5
"""Of a time constant below which an experiment shows hardly more than its beginning."""

OF_A_DELAY = 10.0
"""Times a delay below which much of an experiment is what began before it."""

SHOWN = 4.0
"""Times as long as that has to be what the estimation experiments have: what they do not show either is no fault of validation."""


def short_validation(
    data: DataSet, constant: float | None = None, delays: Mapping[str, float] | None = None
) -> str | None:
    """A sentence without its full stop where the validation experiments are too short to judge by; else None.

    Args:
        constant: the slowest time constant of the machine, in s, where it is known.
        delays: of the machine, in s, by what a reader calls them.
    """
    validation, estimation = ([r.seconds for r in own] for own in (data.validation(), data.estimation()))
    if not validation or not estimation or data.held_out_by_default:
        return None
    longest, estimated = max(validation), max(estimation)
    beside = [f"{_shown(sum(estimation))} of estimation"] if sum(validation) < SMALL * sum(estimation) else []
    if constant is not None and longest < OF_A_TIME_CONSTANT * constant <= estimated / SHOWN:
        beside.append(f"a slowest time constant of {_shown(constant)} by the model's values")
    for name, delay in (delays or {}).items():
        if longest < OF_A_DELAY * delay <= estimated / SHOWN:
            beside.append(f"{name} of {_shown(delay)}")
    if not beside:
        return None
    what = "the validation experiment lasts" if len(validation) == 1 else "the longest validation experiment lasts"
    return f"{what} {_shown(longest)}, which is short beside {' and '.join(beside)}: hardly more than its beginning is judged"


def slowest_time_constant(model: GreyBoxModel, problem: Problem) -> float | None:
    """The largest time constant, in s, of a model linearised where the first experiment begins; None where none decays, or none is known.

    Args:
        problem: its values, start states and records.
    """
    x, u = torch.as_tensor(problem.initial[0, : len(model.states)]), torch.as_tensor(problem.records.u[:, :1])
    p = parameter_signals({q.name: problem.values_by_name[q.name] for q in model.declared_parameters})
    try:
        matrix = torch.autograd.functional.jacobian(lambda s: model.rates(s[:, None], u, p)[:, 0], x).numpy()
        decay = -np.linalg.eigvals(matrix).real
    except Exception:  # equations may do anything; what is wrong with them is told where they are run
        return None
    slow = decay[decay > 1e-9 * np.abs(decay).max(initial=0.0)]
    return float(1.0 / slow.min()) if len(slow) else None


def _shown(time: float) -> str:
    return f"{time:.0f} s" if time >= 1000.0 else f"{time:.3g} s"
