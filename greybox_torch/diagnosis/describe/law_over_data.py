"""A static law over what the data say: the curve that they ask for in its place, with a band, and the force that each stretch asks for.

Around the fitted model a free curve of the law's signal is added, and the stretches' errors are regressed on it, start states free and all
other parameters as fitted. Law plus correction is what the data say, whatever shape the law has; law plus the constant force that one
stretch alone asks for is a partial residual, the point that a plot of a linear regression would have.

Source: W. A. Larsen, S. J. McCleary, "The use of partial residual plots in regression analysis", Technometrics 14(3), 1972; bands from the
scatter over stretches: H. White, Econometrica 48(4), 1980.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from greybox_torch.diagnosis.curve import Curve, FreeCurve
from greybox_torch.diagnosis.describe.profiles import law_curve
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.screen.candidates import FLEXIBLE
from greybox_torch.diagnosis.screen.score_test import Projected, Screen
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, states_along
from greybox_torch.linear_algebra import eigh
from greybox_torch.mechanisms import shift
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Signals
from greybox_torch.model.ports import value_of

KNOTS = 14
"""Of the free curve."""

MOST_POINTS = 400
"""Stretches that are shown, spread evenly over the records."""

CERTAIN = 0.15
"""Largest standard deviation of a stretch's force that is shown, as a share of the law's reach; wider ones where hardly any is smaller."""

VISITED = (0.002, 0.998)
"""Quantiles of the signal along the records between which the free curve is shown."""

SUM_OF_BUMPS = float(np.sqrt(np.pi))
"""Sum of the bumps of a curve whose heights are one."""


def over_data(study: Study, fitted: Hypothesis, attachment: Attachment, final: Problem) -> Curve | None:
    """The law's own curve, with the free curve where the law is one of a single signal and without memory.

    Args:
        fitted: with the effect, over windows.
        final: with the effect, at the values that the verdict gives.
    """
    model, around = fitted.model, study.surroundings[attachment.port]
    assert isinstance(model, AugmentedModel)
    drawn = law_curve(model, attachment, around, final)
    signal = _signal(model, attachment, around)
    fitted_to = law_curve(model, attachment, around, fitted.fits[0].problem)
    if drawn is None or fitted_to is None or signal is None:
        return drawn
    seen = fitted_to.values + (fitted_to.force if attachment.mechanism.kinematic else 0.0)
    if attachment.mechanism.kinematic:
        drawn = _as_force(model, attachment, around, drawn, final.parameter_tensors)
        fitted_to = _as_force(model, attachment, around, fitted_to, fitted.fits[0].problem.parameter_tensors)
    free = _free_curve(study, fitted, attachment, signal, fitted_to, seen)
    return replace(drawn, free=free)


def _signal(model: AugmentedModel, attachment: Attachment, around: Surroundings) -> str | None:
    """The only signal that a law without memory depends on, if a free curve can be drawn over it there."""
    mechanism = attachment.mechanism
    site = model.local.ports[attachment.port]
    signals = mechanism.signals()
    several = len(set(signals) | set(mechanism.needs)) > 1 or mechanism.links
    if several or not signals or hasattr(mechanism, "order") or mechanism.states(around):
        return None
    return signals[0] if signals[0] in FLEXIBLE.get(site.kind, ()) else None


def _as_force(
    model: AugmentedModel, attachment: Attachment, around: Surroundings, curve: Curve, values: Signals
) -> Curve:
    """The curve of a law that changes a coupling's deflection, as the force at the port that does the same, all else at rest."""
    alone = AugmentedModel(model.base, [attachment], model.surroundings)
    grid = torch.as_tensor(curve.values, dtype=torch.float64)
    zero = torch.zeros_like(grid)
    x = shift.moved(Signals("state", {s.name: zero for s in alone.states}), attachment.shifted_state, grid)
    u = Signals("input", {one.name: zero for one in alone.inputs})

    def rates(of: AugmentedModel, force: float) -> torch.Tensor:
        ports = Signals("port", {q.name: zero + force * (q.name == attachment.port) for q in of.all_ports})
        found = of.derivative(x, u, values, ports)
        return torch.stack([torch.as_tensor(found[s.name], dtype=torch.float64) + zero for s in model.base.states])

    with torch.no_grad():
        plain = AugmentedModel(model.base, [], model.surroundings)
        without, pushed, with_law = rates(plain, 0.0), rates(plain, 1.0), rates(alone, 0.0)
        slope = pushed - without
        force = ((with_law - without) * slope).sum(dim=0) / (slope**2).sum(dim=0)
    if not bool(torch.isfinite(force).all()):
        return curve
    return replace(curve, force=force.numpy(), force_unit=around.force_unit)


def _free_curve(
    study: Study, fitted: Hypothesis, attachment: Attachment, signal: str, curve: Curve, seen: np.ndarray
) -> FreeCurve | None:
    """What the data add to ``curve``, as a curve of the signal as the model has it, ``seen`` at the curve's values."""
    fit, unknown = fitted.fits[0], Unknown(signal, KNOTS)
    probe = attach(study.problem.model, attachment.port, unknown)
    screen = Screen.of(study.problem.model, fitted.effects, [probe], study.surroundings, [], study.options)
    inner, right = _normals(screen.projected(fit), KNOTS)
    if not (np.isfinite(inner).all() and np.isfinite(right).all() and inner.any()):
        return None
    heights, covariance = _regressed(inner, right, fit.mean_square)
    bumps = _bumps(unknown, study.surroundings[attachment.port], seen)
    along = _along(fitted, attachment, signal)
    low, high = np.quantile(along, VISITED)
    inside = (curve.values >= low) & (curve.values <= high)
    force = np.where(inside, curve.force + bumps @ heights, np.nan)
    spread = np.where(inside, np.sqrt(np.einsum("ni,ij,nj->n", bumps, covariance, bumps)), np.nan)
    return FreeCurve(force, spread, *_points(fit, inner, right, along, curve), fit.windows.steps)


def _normals(projected: Projected, count: int) -> tuple[np.ndarray, np.ndarray]:
    """By window, the normal matrix (W, k, k) of the heights and its right-hand side (W, k), start states projected out."""
    inner, right = projected.blocks(np.arange(count)[None])
    return inner[:, 0], right[:, 0]


def _regressed(inner: np.ndarray, right: np.ndarray, mean_square: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights (k,) and their covariance (k, k): from the scatter over windows, and no less than white errors would give."""
    total, wanted = inner.sum(axis=0), right.sum(axis=0)
    values, vectors = eigh(total)
    kept = values > 1e-9 * values[-1]
    root = vectors[:, kept] / values[kept]
    heights = root @ (vectors[:, kept].T @ wanted)
    left = (right - inner @ heights) @ root
    scatter, white = left.T @ left, mean_square * np.diag(1.0 / values[kept])
    back = vectors[:, kept]
    by_scatter, by_white = (back @ m @ back.T for m in (scatter, white))
    grown = np.sqrt(np.maximum(1.0, np.diag(by_white) / np.maximum(np.diag(by_scatter), 1e-300)))
    return heights, by_scatter * grown[:, None] * grown[None, :]


def _bumps(unknown: Unknown, around: Surroundings, values: np.ndarray) -> np.ndarray:
    """The bumps (n, k) of a free curve at values (n,) of its signal."""
    first, second = unknown.centres(around)[:2]
    place = np.clip((values - first) / (second - first), 1.0, unknown.knots - 2.0)
    return np.exp(-((place[:, None] - np.arange(unknown.knots)) ** 2))


def _along(fitted: Hypothesis, attachment: Attachment, signal: str) -> np.ndarray:
    """The signal at the port along the records (N,), as the states have it, changed by no other law."""
    fit, model = fitted.fits[0], fitted.model
    assert isinstance(model, AugmentedModel)
    states = states_along(fit, fitted.simulator)
    x, u = model.named_signals(torch.as_tensor(states.T), torch.as_tensor(fit.problem.driving_records.u))
    site, values = model.local.ports[attachment.port], fit.problem.parameter_tensors
    if signal in site.signals:
        found = value_of(site.signals[signal], x, u, values)
    else:
        found = model.local_signals(attachment, x, u, values)[signal]
    return np.broadcast_to(np.asarray(found, dtype=float), len(states))


def _points(
    fit: WindowFit, inner: np.ndarray, right: np.ndarray, along: np.ndarray, curve: Curve
) -> tuple[np.ndarray, np.ndarray]:
    """The mean signal (m,) over stretches and the force (m,) that each asks for there, of those that say something of it."""
    information = inner.sum(axis=(1, 2)) / SUM_OF_BUMPS**2
    said = np.flatnonzero(information > 0)
    force = right.sum(axis=1)[said] / SUM_OF_BUMPS / information[said]
    deviation = np.sqrt(fit.mean_square / information[said])
    size = fit.windows.steps
    middle = np.array([along[a : a + size].mean() for a in fit.windows.start[said]])
    reach = float(np.ptp(curve.force)) or float(np.abs(curve.force).max())
    sure = deviation < max(CERTAIN * reach, float(np.quantile(deviation, 0.25, method="lower")) if said.size else 0.0)
    chosen = np.flatnonzero(sure)
    chosen = chosen[np.linspace(0, len(chosen) - 1, min(len(chosen), MOST_POINTS)).astype(int)]
    return middle[chosen], np.interp(middle[chosen], curve.values, curve.force) + force[chosen]
