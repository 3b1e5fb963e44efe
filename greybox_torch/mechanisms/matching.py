"""From a learned curve to the named laws that could have drawn it: the verdict `unknown` asks this, and so does a trained network."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.linear_algebra import least_squares as linear_least_squares
from greybox_torch.mechanisms.left_beside import LeftBeside
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.model import Signals
from greybox_torch.model.signals import parameter_signals

LEAST_MATCH = 0.5
"""Share of the curve's mean square that a law must match to be worth a refit."""

MOST_LAWS = 3

LEAST_BESIDE_GAIN = 0.02
"""Share of the curve's mean square that a change of gain must leave for a law without an amplitude to count at all."""


@dataclass(frozen=True)
class Match:
    """A law, the share of the learned force's weighted mean square that it matches, and its parameters by name, in their units."""

    law: Mechanism
    share: float
    values: dict[str, float]


def matching_laws(
    kind: str,
    around: Surroundings,
    signals: Mapping[str, torch.Tensor],
    force: np.ndarray,
    weight: np.ndarray,
    but: Collection[str] = (),
    beside: np.ndarray | None = None,
) -> list[Match]:
    """Every law without memory that depends on no other signals, least-squares fitted to a learned force, best matches first.

    Args:
        kind: of the port.
        signals: the local signals (N,) that the learned force is a function of.
        force: the learned force (N,) there, and ``weight`` (N,) what each point counts.
        but: names of laws that are left out, since they are there already.
        beside: forces (N, k) in any amounts of which may act as well, such as those that changes of the model's own parameters stand for.
            What a law matches is then a share of what these leave.
    """
    left = LeftBeside.of(beside, force, weight)
    found = []
    for law in laws_of(kind, around, signals, but):
        trials = _trials(law.nearest(around, signals, left.force, weight), around, signals, force, left)
        if trials:
            found.append(max(trials, key=lambda match: match.share))
    return sorted(found, key=lambda match: -match.share)


def laws_of(
    kind: str, around: Surroundings, signals: Collection[str], but: Collection[str] = ()
) -> Iterator[Mechanism]:
    """The laws without memory at a kind of port that depend on no other ``signals``, or not at rest.

    ``but`` as for :func:`matching_laws`.
    """
    for law in (m() for name, m in LIBRARY.items() if name not in but):
        drawn = bool(signals) and set(law.needs) - set(law.at_rest) <= set(signals)
        if kind in law.kinds and drawn and not law.kinematic and not law.states(around):
            yield law


def worth_a_refit(matches: Collection[Match]) -> list[Match]:
    """The few of ``matches``, best first, that come near to the curve."""
    return [match for match in matches if match.share > LEAST_MATCH][:MOST_LAWS]


def kinematic_laws(around: Surroundings, signals: Collection[str]) -> list[tuple[Mechanism, list[dict[str, float]]]]:
    """Laws that change a coupling's deflection and depend on no other ``signals``, with sizes to begin with.

    What they do to the force depends on the spring, so their size is to be tried, not fitted to a curve.
    """
    laws = [law for law in (m() for m in LIBRARY.values()) if law.kinematic and set(law.needs) <= set(signals)]
    return [(law, [dict(probe.values) for probe in law.probes(around) if probe.values]) for law in laws]


def _trials(
    law: Mechanism, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, left: LeftBeside
) -> list[Match]:
    """The law fitted in its linear parameters at every shape that it is looked for with, or in its shape where it has no amplitude."""
    if any(SHARE in probe.directions for probe in law.probes(around)):
        return _shape_trials(law, around, signals, force, left)
    results, bounds = [], {p.name: p.bounds for p in law.parameters(around)}
    target = left.by(force)
    for probe in law.probes(around):
        columns = left.columns(force_columns(law, around, signals, probe))
        size = linear_least_squares(columns, target, rcond=1e-10)
        size = np.array([np.clip(v, *bounds[n]) for n, v in zip(probe.directions, size, strict=True)])
        share = left.share_of(force, target - columns @ size)
        results.append(
            Match(law, share, {**probe.values, **dict(zip(probe.directions, map(float, size), strict=True))})
        )
    if law.at_rest and results:
        results.append(_placed(max(results, key=lambda match: match.share), around, signals, force, left))
    return results


def _placed(
    match: Match, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, left: LeftBeside
) -> Match:
    """A match with what it has fitted to the curve: a stop begins where the force does, not where it was looked for."""
    from scipy.optimize import least_squares  # a fifth of a second to import, which only some diagnoses need

    free = [p for p in match.law.parameters(around) if not p.fixed and match.values.get(p.name, p.value) != 0.0]
    names, (low, high) = [p.name for p in free], np.array([p.bounds for p in free]).T

    def lacking(z: np.ndarray) -> np.ndarray:
        values = {**match.values, **dict(zip(names, map(float, z), strict=True))}
        return left.by(force - law_force(match.law, around, signals, values))

    start = np.array([match.values.get(p.name, p.value) for p in free])
    scale = np.maximum(np.abs(start), 1e-12)
    found = least_squares(lacking, np.clip(start, low, high), bounds=(low, high), x_scale=scale, max_nfev=40)
    share = left.share_of(force, found.fun)
    return Match(match.law, share, {**match.values, **dict(zip(names, map(float, found.x), strict=True))})


def _shape_trials(
    law: Mechanism, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, left: LeftBeside
) -> list[Match]:
    """A law that no parameter is an amplitude of (a saturation, a dead band), fitted from every shape that it is looked for with.

    While the curve was learned, the gain of the model may have moved to meet it half way: the curve is then α φ(u) − u, with φ(u) the
    input that acts. So a part of the curve that is proportional to φ(u) is left open; where a gain is all that there is to explain,
    the law counts for nothing.
    """
    from scipy.optimize import least_squares  # a fifth of a second to import, which only some diagnoses need

    free = [p for p in law.parameters(around) if not p.fixed]
    low, high = np.array([p.bounds for p in free]).T
    signal = next(iter(signals.values())).numpy()
    alone = float(np.sum(left.by(force) ** 2))
    after_gain = float(np.sum(_without(left.by(signal), left.by(force)) ** 2))

    def lacking(z: np.ndarray) -> np.ndarray:
        drawn = law_force(law, around, signals, dict(zip((p.name for p in free), map(float, z), strict=True)))
        return _without(left.by(signal + drawn), left.by(force - drawn))

    results = []
    for probe in law.probes(around):
        start = np.array([probe.values.get(p.name, p.value) for p in free])
        inside = np.clip(start, low + 1e-9 * np.abs(high), high - 1e-9 * np.abs(high))
        found = least_squares(
            lacking, inside, bounds=(low, high), x_scale=np.maximum(np.abs(inside), 1e-12), max_nfev=40
        )
        explained = after_gain - float(np.sum(found.fun**2))
        share = explained / after_gain if after_gain > LEAST_BESIDE_GAIN * alone else 0.0
        results.append(Match(law, share, dict(zip((p.name for p in free), map(float, found.x), strict=True))))
    return results


def _without(direction: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """A vector less its part along another."""
    size = float(direction @ direction)
    return vector if size == 0.0 else vector - direction * float(direction @ vector) / size


def force_columns(
    law: Mechanism, around: Surroundings, signals: Mapping[str, torch.Tensor], probe: Probe
) -> np.ndarray:
    """The law's forces (N, d) per unit of each of its linear parameters, at local signals (N,)."""
    per_unit = ({other: 1.0 if other == name else 0.0 for other in probe.directions} for name in probe.directions)
    return np.stack([law_force(law, around, signals, {**probe.values, **unit}) for unit in per_unit], axis=1)


def law_force(
    law: Mechanism, around: Surroundings, signals: Mapping[str, torch.Tensor], values: Mapping[str, float]
) -> np.ndarray:
    """The force (N,) of a law without memory at local signals (N,), at rest where those do not say how fast it moves.

    Parameters that ``values`` do not mention are as declared.
    """
    complete = {p.name: p.value for p in law.parameters(around)} | dict(values)
    p = parameter_signals(complete)
    still = dict.fromkeys(law.at_rest, torch.zeros_like(next(iter(signals.values()))))
    force = law.force(Signals("signal", {**still, **signals}), p, Signals("memory", {}))
    return np.broadcast_to(np.asarray(force), next(iter(signals.values())).shape).astype(float)
