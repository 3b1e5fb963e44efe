"""From the looks of a screen to the few hypotheses worth a refit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnose.screen import Look
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings
from greybox_torch.mechanisms.unknown import Unknown

NAMED_PER_LENGTH = 5
CURVES_PER_LENGTH = 1
LEAST_SHARE = 0.003
ALIKE = 0.7
STARTS_PER_LENGTH = 2


@dataclass(frozen=True)
class Leader:
    """A hypothesis worth a refit: the attachment, the start values that the screen suggests, and the largest share it explained."""

    attachment: Attachment
    starts: tuple[dict[str, float], ...]
    explained: float


def leaders(
    looks: Sequence[Sequence[Look]], fits: Sequence[WindowFit], surroundings: dict[str, Surroundings]
) -> list[Leader]:
    """The best candidates at any window length, each with start values from every length at which it leads.

    Args:
        looks: per window length, the looks of the screen.
        fits: per window length, the fit that was looked at.
    """
    found: dict[tuple, Leader] = {}
    for at_length, fit in zip(looks, fits, strict=True):
        best = _best_of_each(at_length, surroundings)
        named = [b for b in best if not isinstance(b.attachment.mechanism, Unknown)][:NAMED_PER_LENGTH]
        curves = [b for b in best if isinstance(b.attachment.mechanism, Unknown)][:CURVES_PER_LENGTH]
        for look in named + curves:
            if look.explained < LEAST_SHARE:
                continue
            identity = identity_of(look.attachment)
            alike = [
                l for l in at_length if identity_of(l.attachment) == identity and l.explained > ALIKE * look.explained
            ]
            near = sorted(alike, key=lambda l: -l.explained)[:STARTS_PER_LENGTH]
            new = tuple({**_values(fit), **_suggested(one, surroundings)} for one in near)
            before = found.get(identity)
            starts = new if before is None else (*before.starts, *new)
            found[identity] = Leader(look.attachment, starts, max(look.explained, before.explained if before else 0.0))
    return sorted(found.values(), key=lambda leader: -leader.explained)


def identity_of(attachment: Attachment) -> tuple:
    """What makes two attachments the same hypothesis."""
    mechanism = attachment.mechanism
    order = getattr(mechanism, "order", None)
    return (
        attachment.port,
        mechanism.name,
        getattr(mechanism, "signal", ""),
        None if order is None else round(order, 2),
    )


def _best_of_each(looks: Sequence[Look], surroundings: dict[str, Surroundings]) -> list[Look]:
    best: dict[tuple, Look] = {}
    for look in looks:
        identity = identity_of(look.attachment)
        if np.isfinite(look.explained) and _physical(look, surroundings):
            if identity not in best or look.explained > best[identity].explained:
                best[identity] = look
    return sorted(best.values(), key=lambda look: -look.explained)


def _physical(look: Look, surroundings: dict[str, Surroundings]) -> bool:
    """Whether the estimated size has the sign that the law allows (at least one of several directions)."""
    bounds = {p.name: p.bounds for p in look.attachment.mechanism.parameters(surroundings[look.attachment.port])}
    bounds[SHARE] = (0.0, np.inf)
    inside = [
        bounds[name][0] <= size <= bounds[name][1] for name, size in zip(look.probe.directions, look.size, strict=True)
    ]
    return any(inside)


def _suggested(look: Look, surroundings: dict[str, Surroundings]) -> dict[str, float]:
    prefix = look.attachment.prefix
    values = dict(look.probe.values)
    values |= {n: float(v) for n, v in zip(look.probe.directions, look.size, strict=True) if n != SHARE}
    bounds = {p.name: p.bounds for p in look.attachment.mechanism.parameters(surroundings[look.attachment.port])}
    return {f"{prefix}.{name}": float(np.clip(value, *bounds[name])) for name, value in values.items()}


def _values(fit: WindowFit) -> dict[str, float]:
    return dict(zip(fit.problem.names, map(float, fit.problem.values), strict=True))
