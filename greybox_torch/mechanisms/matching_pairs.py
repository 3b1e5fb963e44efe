"""From a learned curve to two named laws that could have drawn it together: dry friction of two levels, or dry friction and drag."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import torch

from greybox_torch.linear_algebra import least_squares
from greybox_torch.mechanisms.matching import force_columns, laws_of
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings

LEAST_MATCH = 0.8
"""Share of what a straight line leaves of the curve that two laws must match together to be worth a refit."""

LEAST_OF_EACH = 0.1
"""Share of it that each must add to the other."""

LEAST_BESIDE_LINE = 0.01
"""The same where one of the two may be a line, beside whose square an offset has a small one."""


@dataclass(frozen=True)
class Look:
    """A law with the parameters of one of its probes, and the forces (N, d) per unit of those that it is linear in."""

    law: Mechanism
    probe: Probe
    columns: np.ndarray


@dataclass(frozen=True)
class PairMatch:
    """Two laws with their parameters, the one that matches more by itself first, and the share that they match together."""

    laws: tuple[Mechanism, Mechanism]
    values: tuple[dict[str, float], dict[str, float]]
    share: float


def matching_pair(
    kind: str,
    around: Surroundings,
    signals: Mapping[str, torch.Tensor],
    force: np.ndarray,
    weight: np.ndarray,
    but: Collection[str] = (),
    *,
    line_open: bool = True,
) -> PairMatch | None:
    """The two laws that match a learned force best together; None where one does as well, or no two come near it.

    Arguments as for :func:`greybox_torch.mechanisms.matching.matching_laws`, and:

    Args:
        line_open: whether a straight line is left open beside the two, as the model's own damping may have moved while the curve was
            learned. Without it one of the two may be the line, such as an input's gain beside its offset.
    """
    root, line = np.sqrt(weight), next(iter(signals.values())).numpy()[:, None]
    line, least = (line, LEAST_OF_EACH) if line_open else (line[:, :0], LEAST_BESIDE_LINE)
    total = _left(line, force, root)[1]
    if not total > 0.0:
        return None
    looks = _looks(kind, around, signals, force, weight, but)
    alone = [1.0 - _left(np.hstack([line, a.columns]), force, root)[1] / total for a in looks]
    best: PairMatch | None = None
    for (a, of_a), (b, of_b) in combinations(zip(looks, alone, strict=True), 2):
        if a.law.name == b.law.name or {a.law.name, b.law.name} & {*a.law.generalises, *b.law.generalises}:
            continue
        sizes, left = _left(np.hstack([line, a.columns, b.columns]), force, root)
        share = 1.0 - left / total
        if share < max(LEAST_MATCH, least + max(of_a, of_b)) or (best is not None and share <= best.share):
            continue
        own = np.split(sizes[line.shape[1] :], [a.columns.shape[1]])
        if _within_bounds(a, own[0], around) and _within_bounds(b, own[1], around):
            told = [(a.law, _values(a, own[0])), (b.law, _values(b, own[1]))]
            (first, of_first), (second, of_second) = told if of_a >= of_b else told[::-1]
            best = PairMatch((first, second), (of_first, of_second), share)
    return best


def _looks(
    kind: str,
    around: Surroundings,
    signals: Mapping[str, torch.Tensor],
    force: np.ndarray,
    weight: np.ndarray,
    but: Collection[str],
) -> list[Look]:
    """Every law without memory that is linear in its sizes and depends on no other signals, with every shape it is looked for with."""
    found: list[Look] = []
    for law in (one.nearest(around, signals, force, weight) for one in laws_of(kind, around, signals, but)):
        probes = law.probes(around)
        if set(but) & set(law.generalises) or any(SHARE in probe.directions for probe in probes):
            continue
        found += [Look(law, probe, force_columns(law, around, signals, probe)) for probe in probes]
    return found


def _left(columns: np.ndarray, force: np.ndarray, root: np.ndarray) -> tuple[np.ndarray, float]:
    """The sizes of ``columns`` (N, d) that come nearest to a force (N,), and the weighted sum of squares that they leave."""
    sizes = least_squares(columns * root[:, None], force * root, rcond=1e-10)
    return sizes, float(np.sum((root * (force - columns @ sizes)) ** 2))


def _within_bounds(look: Look, sizes: np.ndarray, around: Surroundings) -> bool:
    bounds = {p.name: p.bounds for p in look.law.parameters(around)}
    named = zip(look.probe.directions, sizes, strict=True)
    return all(bounds[name][0] <= size <= bounds[name][1] for name, size in named)


def _values(look: Look, sizes: np.ndarray) -> dict[str, float]:
    return {**look.probe.values, **dict(zip(look.probe.directions, map(float, sizes), strict=True))}
