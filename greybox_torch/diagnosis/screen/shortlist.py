"""From the looks of a screen to the few hypotheses worth a refit."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings
from greybox_torch.mechanisms.unknown import Unknown

NAMED_PER_LENGTH = 4
CURVES_PER_LENGTH = 1
TIE, MOST_TIED = 0.97, 8
"""Share of the best look's from which a look ties with it, and how many of those are followed."""

LEAST_SHARE = 0.008
CAUTIOUS = 0.1
"""Part of a suggested curve that a refit also begins with."""


@dataclass(frozen=True)
class Candidate:
    """A hypothesis worth a refit: the attachment, the start values that the screen suggests, and the largest share it explained."""

    attachment: Attachment
    starts: tuple[dict[str, float], ...]
    explained: float

    @property
    def unknown(self) -> bool:
        """Whether it is a free curve."""
        return isinstance(self.attachment.mechanism, Unknown)


def shortlist(
    looks: Sequence[Sequence[ScreenScore]],
    fits: Sequence[WindowFit],
    surroundings: Mapping[str, Surroundings],
    card: Mapping[str, float],
) -> list[Candidate]:
    """The best candidates at any window length, each with start values from every length at which it leads.

    Args:
        looks: per window length, the looks of the screen.
        fits: per window length, the fit that was looked at.
        card: the values that the problem began with. A model that lacks an effect bends its parameters to make up for it, at times into
            a valley that the complete model cannot leave again; so every candidate is also refitted from where the user began.
    """

    def first_few(best: list[ScreenScore]) -> list[ScreenScore]:
        named = _with_ties([b for b in best if not isinstance(b.attachment.mechanism, Unknown)])
        return named + [b for b in best if isinstance(b.attachment.mechanism, Unknown)][:CURVES_PER_LENGTH]

    return _followed(looks, fits, surroundings, card, first_few)


def elsewhere(
    attachment: Attachment,
    known: Collection[Attachment],
    looks: Sequence[Sequence[ScreenScore]],
    fits: Sequence[WindowFit],
    surroundings: Mapping[str, Surroundings],
    card: Mapping[str, float],
) -> list[Candidate]:
    """A law, and the laws that it contains, at every port where it was looked at, without those ``known``.

    Arguments as for :func:`shortlist`. A look is linear: where an effect is large, another place than the right one may explain more of it
    at first sight.
    """
    names = {attachment.mechanism.name, *attachment.mechanism.generalises}
    there = {identity_of(a) for a in known}

    def not_known(best: list[ScreenScore]) -> list[ScreenScore]:
        return [b for b in best if b.attachment.mechanism.name in names and identity_of(b.attachment) not in there]

    return _followed(looks, fits, surroundings, card, not_known)


def _followed(
    looks: Sequence[Sequence[ScreenScore]],
    fits: Sequence[WindowFit],
    surroundings: Mapping[str, Surroundings],
    card: Mapping[str, float],
    choose: Callable[[list[ScreenScore]], list[ScreenScore]],
) -> list[Candidate]:
    """What ``choose`` takes of the looks at any window length, best of each hypothesis first, as shortlist."""
    found: dict[tuple, Candidate] = {}
    for at_length, fit in zip(looks, fits, strict=True):
        fitted = dict(zip(fit.problem.names, map(float, fit.problem.values), strict=True))
        for look in choose(_best_of_each(at_length, surroundings)):
            if look.explained < LEAST_SHARE:
                continue
            identity = identity_of(look.attachment)
            suggested = _suggested(look, surroundings)
            starts = ({**fitted, **card, **suggested}, {**fitted, **suggested})
            if isinstance(look.attachment.mechanism, Unknown):
                starts = ({**fitted, **suggested}, {**fitted, **_lower(look, suggested)}, starts[0])
            before = found.get(identity)
            if before is None:
                found[identity] = Candidate(look.attachment, starts, look.explained)
            else:
                explained = max(look.explained, before.explained)
                order = (*starts, *before.starts) if look.explained > before.explained else (*before.starts, *starts)
                found[identity] = Candidate(look.attachment, order, explained)
    return sorted(found.values(), key=lambda leader: -leader.explained)


def _with_ties(ranked: Sequence[ScreenScore]) -> list[ScreenScore]:
    """The first few, and what explains as much as the best: what the data cannot tell apart has to share the probability."""
    tied = sum(look.explained > TIE * ranked[0].explained for look in ranked)
    return list(ranked[: min(max(NAMED_PER_LENGTH, tied), MOST_TIED)])


def identity_of(attachment: Attachment) -> tuple:
    """What makes two attachments the same hypothesis."""
    mechanism = attachment.mechanism
    order = getattr(mechanism, "order", None)
    return (
        attachment.port,
        mechanism.name,
        attachment.label,
        getattr(mechanism, "signal", ""),
        None if order is None else round(order, 2),
    )


def _best_of_each(looks: Sequence[ScreenScore], surroundings: Mapping[str, Surroundings]) -> list[ScreenScore]:
    best: dict[tuple, ScreenScore] = {}
    for look in looks:
        identity = identity_of(look.attachment)
        before = best[identity].explained if identity in best else -np.inf
        if np.isfinite(look.explained) and look.explained > before and _physical(look, surroundings):
            best[identity] = look
    return sorted(best.values(), key=lambda look: -look.explained)


def _physical(look: ScreenScore, surroundings: Mapping[str, Surroundings]) -> bool:
    """Whether the estimated size has the sign that the law allows (at least one of several directions)."""
    bounds = {p.name: p.bounds for p in look.attachment.mechanism.parameters(surroundings[look.attachment.port])}
    bounds[SHARE] = (0.0, np.inf)
    inside = [
        bounds[name][0] <= size <= bounds[name][1] for name, size in zip(look.probe.directions, look.size, strict=True)
    ]
    return any(inside)


def _lower(look: ScreenScore, suggested: Mapping[str, float]) -> dict[str, float]:
    """The suggested values with a smaller amplitude: the whole of a curve at once can lead out of the valley its parent is in."""
    heights = {f"{look.attachment.prefix}.{n}" for n in look.probe.directions}
    return {n: CAUTIOUS * v if n in heights else v for n, v in suggested.items()}


def _suggested(look: ScreenScore, surroundings: Mapping[str, Surroundings]) -> dict[str, float]:
    prefix = look.attachment.prefix
    values = dict(look.probe.values)
    values |= {n: float(v) for n, v in zip(look.probe.directions, look.size, strict=True) if n != SHARE}
    bounds = {p.name: p.bounds for p in look.attachment.mechanism.parameters(surroundings[look.attachment.port])}
    return {f"{prefix}.{name}": float(np.clip(value, *bounds[name])) for name, value in values.items()}
