"""A free curve without the bumps that the recordings do not ask for.

What a bump has of noise and of other errors is a force that is not there: where the machine is nearly at rest, or nothing pulls it back, a
small one moves the free run of another experiment far. Where nothing shows a force, the curve is zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_information import window_information
from greybox_torch.linear_algebra import solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown


def with_sparser_curve(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with its curve without the bumps that bring nothing that could be claimed; as it is where each of them counts."""
    curve = next((e for e in state.effects if isinstance(e.mechanism, Unknown)), None)
    if curve is None:
        return state
    drawn, mechanism = state.current, curve.mechanism
    assert isinstance(mechanism, Unknown)
    idle = _idle(drawn, curve, study.settings.least_gain)
    if not idle:
        return state
    study.working_on("leaving out what the curve does not need")
    sparser = replace(curve, mechanism=mechanism.altered(left_out=idle))
    effects = tuple(sparser if e is curve else e for e in drawn.effects)
    fitted = fit(study, effects, [drawn.values()], drawn.fits[0], limits=study.budget.window_iterations)
    if fitted is None or fitted.score > drawn.score + study.settings.curve_margin:
        return state
    state = state.at(fitted)
    yield state
    return state


def _idle(fitted: Hypothesis, curve: Attachment, least: float) -> tuple[int, ...]:
    """The bumps of ``curve`` without which the score would rise by less than ``least``, everything else refitted, by linearisation."""
    mechanism = curve.mechanism
    assert isinstance(mechanism, Unknown)
    names = fitted.problem.free_names
    place = {k: names.index(name) for k in mechanism.bumps if (name := f"{curve.prefix}.w_{k}") in names}
    known = [i for f in fitted.fits if (i := window_information(f, fitted.simulator)) is not None]
    if len(place) < len(mechanism.bumps) or len(known) < len(fitted.fits):
        return ()
    idle: list[int] = []
    while len(idle) < len(place) - 1:
        rises = {k: _rise(fitted, known, [place[j] for j in (*idle, k)]) for k in place if k not in idle}
        best = min(rises, key=lambda k: rises[k])
        if rises[best] > least:
            break
        idle.append(best)
    return tuple(sorted(idle))


def _rise(fitted: Hypothesis, informations: Sequence[np.ndarray], out: list[int]) -> float:
    """How much the score rises with the free parameters ``out`` at zero, the others where that is least."""
    rises = []
    for found, information in zip(fitted.fits, informations, strict=True):
        values = found.problem.values[found.problem.free][out]
        rest = np.setdiff1d(np.arange(len(information)), out)
        across = information[rest][:, out]
        own = information[out][:, out] - across.T @ solve(information[rest][:, rest], across)
        rises.append(float(np.log1p(max(values @ own @ values, 0.0) / max(float(found.energies.sum()), 1e-300))))
    return float(np.mean(rises))
