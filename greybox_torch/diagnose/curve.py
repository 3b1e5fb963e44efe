"""From a learned curve to the named laws that could have drawn it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import torch

from greybox_torch.diagnose.candidates import attach
from greybox_torch.diagnose.leaders import Leader
from greybox_torch.diagnose.refit import Hypothesis
from greybox_torch.mechanisms.attachment import Attachment, AugmentedModel
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import GreyBoxModel, Signals

POINTS = 400
LEAST_MATCH = 0.5
"""Share of the curve's variance that a law must match to be worth a refit."""

MOST_LAWS = 3


def laws_on_curve(
    model: GreyBoxModel,
    fitted: Hypothesis,
    curve: Attachment,
    surroundings: Mapping[str, Surroundings],
    card: Mapping[str, float],
) -> list[Leader]:
    """The named laws without memory that depend on the curve's signal alone, least-squares fitted to the curve, best matches first."""
    unknown = curve.mechanism
    assert isinstance(unknown, Unknown) and isinstance(fitted.model, AugmentedModel)
    around = surroundings[curve.port]
    span = around.ranges[unknown.signal]
    grid = torch.linspace(span.low, span.high, POINTS, dtype=torch.float64)
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in fitted.values().items()})
    target = fitted.model.curve(curve, {unknown.signal: grid}, p).detach().numpy()
    weight = _visited(span.rms, grid.numpy())
    site = next(q for q in model.all_ports if q.name == curve.port)
    matches, there = [], {e.mechanism.name for e in fitted.effects if e.port == curve.port}
    for law in (m() for name, m in LIBRARY.items() if name not in there):
        fits_port = site.kind in law.kinds and set(law.needs) <= {unknown.signal}
        if fits_port and not law.kinematic and not law.states(around):
            matches += [
                (share, start, law) for share, start in _matches(law, around, unknown.signal, grid, target, weight)
            ]
    matches.sort(key=lambda match: -match[0])
    base = {n: v for n, v in fitted.values().items() if not n.startswith(f"{curve.prefix}.")}
    found: dict[str, Leader] = {}
    for share, start, law in matches:
        if share > LEAST_MATCH and law.name not in found and len(found) < MOST_LAWS:
            attachment = attach(model, curve.port, law)
            values = {**base, **{f"{attachment.prefix}.{n}": v for n, v in start.items()}}
            found[law.name] = Leader(attachment, ({**values, **card}, values), share)
    return [*found.values(), *_kinematic(model, curve, surroundings, base, card)]


def _kinematic(
    model: GreyBoxModel,
    curve: Attachment,
    surroundings: Mapping[str, Surroundings],
    base: Mapping[str, float],
    card: Mapping[str, float],
) -> list[Leader]:
    """Kinematic laws of the curve's signal: what they do to the force depends on the spring, so their size is tried, not fitted."""
    unknown, around = curve.mechanism, surroundings[curve.port]
    assert isinstance(unknown, Unknown)
    found = []
    for law in (m() for m in LIBRARY.values()):
        if law.kinematic and curve.shifted_state and set(law.needs) <= {unknown.signal}:
            attachment = attach(model, curve.port, law, curve.shifted_state)
            sizes = [probe.values for probe in law.probes(around) if probe.values]
            starts = [{f"{attachment.prefix}.{n}": v for n, v in values.items()} for values in sizes]
            found.append(Leader(attachment, tuple({**base, **card, **start} for start in starts), 0.0))
    return found


def finer(
    fitted: Hypothesis, curve: Attachment, surroundings: Mapping[str, Surroundings]
) -> tuple[Attachment, dict[str, float]]:
    """The curve with twice the knots, and the values of the hypothesis with it: the same curve to begin with."""
    unknown, around = curve.mechanism, surroundings[curve.port]
    assert isinstance(unknown, Unknown) and isinstance(fitted.model, AugmentedModel)
    detailed = Unknown(unknown.signal, 2 * unknown.knots, unknown.factor)
    reached = around.ranges[unknown.signal]
    grid = torch.linspace(reached.low, reached.high, POINTS, dtype=torch.float64)
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in fitted.values().items()})
    target = fitted.model.curve(curve, {unknown.signal: grid}, p).detach().numpy()
    probe = detailed.probes(around)[0]
    columns = np.stack([_column(detailed, around, unknown.signal, grid, probe, n) for n in probe.directions], axis=1)
    heights = np.linalg.lstsq(columns, target, rcond=1e-6)[0]
    values = {n: v for n, v in fitted.values().items() if not n.startswith(f"{curve.prefix}.")}
    values |= {f"{curve.prefix}.{n}": float(h) for n, h in zip(probe.directions, heights, strict=True)}
    return replace(curve, mechanism=detailed), values


def _visited(rms: float, grid: np.ndarray) -> np.ndarray:
    """Weights that count the middle of the range, where the machine was most, more than the ends."""
    return np.exp(-0.5 * (grid / max(2.0 * rms, 1e-12)) ** 2)


def _matches(
    law: Mechanism, around: Surroundings, signal: str, grid: torch.Tensor, target: np.ndarray, weight: np.ndarray
) -> list[tuple[float, dict[str, float]]]:
    results = []
    for probe in law.probes(around):
        if SHARE in probe.directions:
            continue
        columns = np.stack([_column(law, around, signal, grid, probe, name) for name in probe.directions], axis=1)
        root = np.sqrt(weight)[:, None]
        size = np.linalg.lstsq(columns * root, target * root[:, 0], rcond=1e-10)[0]
        bounds = {p.name: p.bounds for p in law.parameters(around)}
        size = np.array([np.clip(v, *bounds[n]) for n, v in zip(probe.directions, size, strict=True)])
        left = float((weight * (target - columns @ size) ** 2).sum())
        share = 1.0 - left / max(float((weight * target**2).sum()), 1e-300)
        results.append((share, {**probe.values, **dict(zip(probe.directions, map(float, size), strict=True))}))
    return results


def _column(
    law: Mechanism, around: Surroundings, signal: str, grid: torch.Tensor, probe: Probe, name: str
) -> np.ndarray:
    """The law's force per unit of one of its linear parameters."""
    values = {p.name: p.value for p in law.parameters(around)} | dict(probe.values)
    values |= {other: 1.0 if other == name else 0.0 for other in probe.directions}
    p = Signals("parameter", {n: torch.tensor(float(v), dtype=torch.float64) for n, v in values.items()})
    force = law.force(Signals("signal", {signal: grid}), p, Signals("memory", {}))
    return np.broadcast_to(np.asarray(force), grid.shape).astype(float)
