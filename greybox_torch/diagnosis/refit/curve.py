"""From a learned curve to the named laws that could have drawn it, as hypotheses; and the same curve drawn more finely."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import torch

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.linear_algebra import least_squares
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.matching import MOST_LAWS, force_columns, kinematic_laws, matching_laws, worth_a_refit
from greybox_torch.mechanisms.matching_pairs import matching_pair
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.reads import reads_nothing_but
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.signals import parameter_signals

POINTS = 400


def laws_on_curve(
    model: GreyBoxModel,
    fitted: Hypothesis,
    curve: Attachment,
    surroundings: Mapping[str, Surroundings],
    card: Mapping[str, float],
) -> list[Candidate]:
    """The named laws without memory that depend on the curve's signal alone, least-squares fitted to the curve, best matches first.

    None where the curve is what another signal is multiplied by. A sensor has few laws without memory, its offset and its gain: they are
    tried however little of the curve they match, which draws what a law elsewhere lacks as well.
    """
    unknown, around = curve.mechanism, surroundings[curve.port]
    assert isinstance(unknown, Unknown)
    if unknown.factor:
        return []
    grid, target = _drawn(fitted, curve, around)
    site = next(q for q in model.all_ports if q.name == curve.port)
    there = {e.mechanism.name for e in fitted.effects if e.port == curve.port}
    weight = _visited(around.ranges[unknown.signal].rms, grid.numpy())
    matches = matching_laws(site.kind, around, {unknown.signal: grid}, target, weight, there)
    base, found = values_without(fitted, curve), []
    further = [m for m in matches if not there & set(m.law.generalises)]
    for match in further[:MOST_LAWS] if site.kind == "sensor" else worth_a_refit(further):
        attachment = attach(model, curve.port, match.law)
        values = {**base, **{f"{attachment.prefix}.{n}": v for n, v in match.values.items()}}
        found.append(Candidate(attachment, ({**values, **card}, values), match.share))
    return [*found, *_kinematic(model, curve, around, base, card)]


def two_laws_on_curve(
    model: GreyBoxModel,
    fitted: Hypothesis,
    curve: Attachment,
    surroundings: Mapping[str, Surroundings],
    *,
    line_open: bool = True,
) -> tuple[tuple[Attachment, Attachment], dict[str, float]] | None:
    """The two named laws that draw the curve together, and all values with them in its place; None where no two come near it.

    ``line_open`` as for :func:`greybox_torch.mechanisms.matching_pairs.matching_pair`.
    """
    unknown, around = curve.mechanism, surroundings[curve.port]
    if not isinstance(unknown, Unknown) or unknown.factor:
        return None
    grid, target = _drawn(fitted, curve, around)
    site = next(q for q in model.all_ports if q.name == curve.port)
    there = {e.mechanism.name for e in fitted.effects if e.port == curve.port}
    weight = _visited(around.ranges[unknown.signal].rms, grid.numpy())
    match = matching_pair(site.kind, around, {unknown.signal: grid}, target, weight, there, line_open=line_open)
    if match is None:
        return None
    first, second = (attach(model, curve.port, law) for law in match.laws)
    own = [{f"{a.prefix}.{n}": v for n, v in k.items()} for a, k in zip((first, second), match.values, strict=True)]
    return (first, second), values_without(fitted, curve) | own[0] | own[1]


def _kinematic(
    model: GreyBoxModel,
    curve: Attachment,
    around: Surroundings,
    base: Mapping[str, float],
    card: Mapping[str, float],
) -> list[Candidate]:
    """Kinematic laws of the curve's signal, where there is a state that carries their change."""
    unknown, found = curve.mechanism, []
    assert isinstance(unknown, Unknown)
    for law, sizes in kinematic_laws(around, {unknown.signal}) if curve.shifted_state else ():
        attachment = attach(model, curve.port, law, curve.shifted_state)
        starts = [{f"{attachment.prefix}.{n}": v for n, v in values.items()} for values in sizes]
        found.append(Candidate(attachment, tuple({**base, **card, **start} for start in starts), 0.0))
    return found


def finer(
    fitted: Hypothesis, curve: Attachment, surroundings: Mapping[str, Surroundings]
) -> tuple[Attachment, dict[str, float]]:
    """The curve with twice the knots, and the values of the hypothesis with it: the same curve to begin with."""
    assert isinstance(curve.mechanism, Unknown)
    return redrawn(fitted, curve, surroundings[curve.port], 2 * curve.mechanism.knots)


def redrawn(
    fitted: Hypothesis, curve: Attachment, around: Surroundings, knots: int
) -> tuple[Attachment, dict[str, float]]:
    """The curve with so many knots over the range of ``around``, and the values of the hypothesis with it.

    One over a part reaches farther with more knots, which are narrower: as far as its outermost bumps do.
    """
    unknown = curve.mechanism
    assert isinstance(unknown, Unknown)
    part = unknown.part
    if part is not None and knots > unknown.knots:
        spacing = (part[1] - part[0]) / (unknown.knots - 1)
        part = (part[0] - spacing, part[1] + spacing)
    attachment = replace(curve, mechanism=unknown.altered(knots=knots, left_out=(), part=part))
    return attachment, values_without(fitted, curve) | _heights(attachment, around, *_drawn(fitted, curve, around))


def over_its_range(
    fitted: Hypothesis, effect: Attachment, surroundings: Mapping[str, Surroundings]
) -> tuple[Attachment, dict[str, float]]:
    """An effect and the values of the hypothesis with it; a curve with all its knots over the range that its signal has now."""
    if not isinstance(effect.mechanism, Unknown):
        return effect, fitted.values()
    return redrawn(fitted, effect, surroundings[effect.port], effect.mechanism.knots)


def absorbed(fitted: Hypothesis, law: Attachment, surroundings: Mapping[str, Surroundings]) -> dict[str, float] | None:
    """The values without a law, its force handed to the free curve of the same signal at its port; None where there is no such curve."""
    same = (e for e in fitted.effects if e is not law and may_be_drawn(law, e, surroundings))
    curve = next(same, None)
    if curve is None:
        return None
    around = surroundings[curve.port]
    grid, target = _drawn(fitted, curve, around)
    force = target + force_of(fitted, law, {_signal(curve): grid})
    return values_without(fitted, law) | _heights(curve, around, grid, force)


def drawing(
    fitted: Hypothesis, law: Attachment, curve: Attachment, surroundings: Mapping[str, Surroundings]
) -> dict[str, float]:
    """The values of a hypothesis with a free curve in the place of a law, whose force it draws over the signal's range."""
    around = surroundings[curve.port]
    assert isinstance(curve.mechanism, Unknown)
    grid = curve.mechanism.grid(around, POINTS)
    force = force_of(fitted, law, {_signal(curve): grid})
    return values_without(fitted, law) | _heights(curve, around, grid, np.broadcast_to(force, len(grid)))


def may_be_drawn(law: Attachment, curve: Attachment, surroundings: Mapping[str, Surroundings]) -> bool:
    """Whether an effect is a free curve that draws a law: of the same signal at the same port, and the law remembers nothing and reads
    nothing else, as the play of a gear reads the rate at which it is damped.
    """
    around, mechanism, unknown = surroundings[law.port], law.mechanism, curve.mechanism
    if curve.port != law.port or not isinstance(unknown, Unknown) or mechanism.kinematic or mechanism.states(around):
        return False
    return not unknown.factor and reads_nothing_but(mechanism, around, unknown.signal)


def _heights(curve: Attachment, around: Surroundings, grid: torch.Tensor, force: np.ndarray) -> dict[str, float]:
    """The heights with which a curve draws a force (N,) over its signal (N,), by least squares."""
    unknown, probe = curve.mechanism, curve.mechanism.probes(around)[0]
    assert isinstance(unknown, Unknown)
    heights = least_squares(force_columns(unknown, around, {unknown.signal: grid}, probe), force, rcond=1e-6)
    return {f"{curve.prefix}.{n}": float(h) for n, h in zip(probe.directions, heights, strict=True)}


def _drawn(fitted: Hypothesis, curve: Attachment, around: Surroundings) -> tuple[torch.Tensor, np.ndarray]:
    """Values of the curve's signal over its range, and the learned force there."""
    assert isinstance(curve.mechanism, Unknown)
    grid = curve.mechanism.grid(around, POINTS)
    return grid, force_of(fitted, curve, {_signal(curve): grid})


def _signal(curve: Attachment) -> str:
    assert isinstance(curve.mechanism, Unknown)
    return curve.mechanism.signal


def force_of(fitted: Hypothesis, effect: Attachment, signals: Mapping[str, torch.Tensor]) -> np.ndarray:
    """The force of an effect without memory at signals (N,); a single number where it depends on none."""
    assert isinstance(fitted.model, AugmentedModel)
    p = parameter_signals(fitted.values())
    return fitted.model.curve(effect, signals, p).detach().numpy()


def values_without(fitted: Hypothesis, effect: Attachment) -> dict[str, float]:
    """The values of everything but an effect."""
    return {n: v for n, v in fitted.values().items() if not n.startswith(f"{effect.prefix}.")}


def _visited(rms: float, grid: np.ndarray) -> np.ndarray:
    """Weights that count the middle of the range, where the machine was most, more than the ends."""
    return np.exp(-0.5 * (grid / max(2.0 * rms, 1e-12)) ** 2)
