"""Where an effect lives: its law as a curve, and the explained error energy over each of its signals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import torch

from greybox_torch.diagnosis.describe.signal_names import unit_at, unit_told
from greybox_torch.diagnosis.effect import Curve, Profile
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.waves import drawn_within
from greybox_torch.simulation.simulator import Simulator

BINS = 24
SEEN_BINS = 100
POINTS = 201


def explained_energy(before: Hypothesis, after: Hypothesis) -> np.ndarray:
    """Per sample of the records (N,), how much less squared error ``after`` leaves than ``before``, on the shortest windows."""
    return _squared_errors(before.fits[0], before.simulator) - _squared_errors(after.fits[0], after.simulator)


def _squared_errors(fit: WindowFit, simulator: Simulator) -> np.ndarray:
    errors = window_errors(fit, simulator) * fit.problem.weights[:, None]
    return np.nansum(errors**2, axis=0)


def profile(name: str, unit: str, values: np.ndarray, energy: np.ndarray) -> Profile:
    """The share of the explained energy over bins of one signal; bins where the effect costs a little count as none."""
    low, high = np.quantile(values, [0.001, 0.999])
    edges = np.linspace(low, max(high, low + 1e-12), BINS + 1)
    inside, levels = np.clip(values, edges[0], edges[-1]), np.unique(values)
    total = np.maximum(np.histogram(inside, edges, weights=energy)[0], 0.0)
    seen = np.histogram(inside, edges)[0] / len(values)
    few = tuple(map(float, levels)) if len(levels) <= BINS else ()
    return Profile(name, unit, edges, total / max(float(total.sum()), 1e-300), seen, few)


def most_of(found: Profile, share: float = 0.8) -> tuple[float, float, float]:
    """The shortest interval of the signal that holds at least ``share`` of the explained energy: low, high, and what it holds."""
    best = (float(found.edges[0]), float(found.edges[-1]), 1.0)
    cumulative = np.concatenate([[0.0], np.cumsum(found.share)])
    for i in range(len(found.share)):
        j = int(np.searchsorted(cumulative, cumulative[i] + share))
        if j < len(found.edges) and found.edges[j] - found.edges[i] < best[1] - best[0]:
            best = (float(found.edges[i]), float(found.edges[j]), float(cumulative[j] - cumulative[i]))
    return best


def law_curve(model: AugmentedModel, attachment: Attachment, around: Surroundings, problem: Problem) -> Curve | None:
    """The effect's own law over its first signal, or the one that it is drawn over, the others held at their root mean square, with the
    sign of those that have one alone; None for laws with memory.

    Of a curve that multiplies a rate what it takes of that rate: speeds are zero. Its ``factor`` goes by its name at the port.
    """
    signals = attachment.mechanism.signals()
    if attachment.mechanism.states(around) or not signals or signals[0] not in around.ranges:
        return None
    name = _over(attachment.mechanism, around)
    site = next(port for port in model.base.all_ports if port.name == attachment.port)
    unit_over = unit_told(model.base, site, around, name)
    grid = _grid(attachment, around, name, unit_over, problem)
    if "delayed" in attachment.mechanism.needs or attachment.mechanism.links:
        return None
    still = [n for n in around.ranges if n.startswith("speed")] if attachment.mechanism.by_rate else ()
    held = {
        n: torch.full_like(grid, 0.0 if n in still else _held(around.ranges[n])) for n in around.ranges if n != name
    }
    force = model.curve(attachment, {**held, name: grid}, problem.parameter_tensors)
    unit = around.units.get("deflection", "") if attachment.mechanism.kinematic else around.force_unit
    values = np.broadcast_to(np.asarray(force, dtype=float), grid.shape)
    factor = _factor(attachment.mechanism, around, held)
    return Curve(name, unit_over, grid.numpy(), values, unit, factor=factor)


def _held(moved: Range) -> float:
    """Where a signal is held: at its root mean square, with its sign where that never changes.

    Seen: a pressure drop that was always negative, and its leak drawn with the sign that it never had.
    """
    return -moved.rms if moved.high <= 0.0 else moved.rms


def _factor(mechanism: Mechanism, around: Surroundings, held: Mapping[str, torch.Tensor]) -> Factor | None:
    """What multiplies a curve, and where it is ``held`` in the drawing; None where there is no such signal."""
    if not isinstance(mechanism, Unknown) or mechanism.factor not in held:
        return None
    return Factor(mechanism.factor, unit_at(around, mechanism.factor), float(held[mechanism.factor][0]))


def _over(mechanism: Mechanism, around: Surroundings) -> str:
    return mechanism.drawn_over if mechanism.drawn_over in around.ranges else mechanism.signals()[0]


def _grid(attachment: Attachment, around: Surroundings, signal: str, unit: str, problem: Problem) -> torch.Tensor:
    """Values of the signal that a law is drawn over, in ``unit``, within its range: more of them where a free curve is over a part of that,
    and of a law that repeats those of a turn, as so many turns would be drawn as a band.
    """
    span, mechanism = around.ranges[signal], attachment.mechanism
    if mechanism.repeats and (order := attachment.own(problem.values_by_name)["order"]):
        return torch.linspace(0.0, drawn_within(order, unit), POINTS, dtype=torch.float64)
    if isinstance(mechanism, Unknown):
        grid = mechanism.grid(around, POINTS)
        return grid[(grid >= span.low) & (grid <= span.high)]
    return torch.linspace(span.low, span.high, POINTS, dtype=torch.float64)


def with_samples(curve: Curve | None, along: Mapping[str, np.ndarray], repeats: bool = False) -> Curve | None:
    """The curve with how many samples lie where along it, by the signals ``along`` the records (N,).

    Args:
        repeats: whether it does beyond its ends, where samples count as well.
    """
    if curve is None or curve.signal not in along:
        return curve
    low, high = float(np.min(curve.values)), float(np.max(curve.values))
    if not low < high:
        return curve
    values = along[curve.signal]
    values = low + np.mod(values - low, high - low) if repeats else values
    return replace(curve, seen=np.histogram(values, SEEN_BINS, (low, high))[0])
