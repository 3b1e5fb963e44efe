"""Which of the hypotheses that a screen ranks over windows of one length are passed on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.one_effect import twins_in
from greybox_torch.mechanisms.unknown import INPUT, Unknown
from greybox_torch.model.ports import Actuator, driving_body

TINY = 1e-12
"""Keeps a share of nothing finite in a quotient."""


def first_few(study: Study, best: Sequence[ScreenScore]) -> list[ScreenScore]:
    """Of the scores, best first, the named ones that are worth a trial, and then the free curves."""
    named = _with_twins(
        study, _with_places(study, names := [b for b in best if not b.attachment.mechanism.free]), names
    )
    curves = _plainest_first([b for b in best if b.attachment.mechanism.free], study.settings.curve_margin)
    return named + _with_parts(study, curves, _with_body(study, curves, study.budget.curves_per_length))


def _with_twins(study: Study, chosen: Sequence[ScreenScore], ranked: Sequence[ScreenScore]) -> list[ScreenScore]:
    """The ``chosen`` scores, with the twins of their laws: the screen sees either at a few delays, and no recording tells which it is."""
    twins = {name for c in chosen for name in twins_in(study.problem.model, c.attachment.mechanism)}
    return [*chosen, *(r for r in ranked if r.attachment.mechanism.name in twins and all(r is not c for c in chosen))]


def _with_places(study: Study, ranked: Sequence[ScreenScore]) -> list[ScreenScore]:
    """:func:`_with_ties`, with the first law at each kind of place that has none among these and explains about as much.

    Seen: a speed sensor's offset of -1.8 rad/s. Seven constant forces, at three bodies and the drive, explained a little more in the screen
    and the offset was never refitted; in its trial it goes five times as far as any of them.
    """
    chosen = _with_ties(study, ranked)
    kinds = {p.name: p.kind for p in study.problem.model.all_ports}
    there = {kinds[c.attachment.port] for c in chosen}
    for score in ranked[len(chosen) :]:
        kind = kinds[score.attachment.port]
        if kind not in there and score.explained > study.budget.part_elsewhere * ranked[0].explained:
            chosen.append(score)
            there.add(kind)
    return chosen


def _with_ties(study: Study, ranked: Sequence[ScreenScore]) -> list[ScreenScore]:
    """The first few, and what explains as much as the best: what the data cannot tell apart has to share the probability."""
    tied = sum(score.explained > study.settings.screen_tie * ranked[0].explained for score in ranked)
    return list(ranked[: min(max(study.budget.named_per_length, tied), study.budget.most_screen_ties)])


def _plainest_first(curves: Sequence[ScreenScore], margin: float) -> list[ScreenScore]:
    """Free curves, best first; before one that another input multiplies the same curve without, unless that leaves more by the margin.

    An input that hardly changes on these experiments (the room's temperature) multiplies as well as a constant does, and not on others.
    """
    first = next(iter(curves), None)
    if first is None or not _of(first)[-1].startswith(INPUT):
        return list(curves)
    alone = next((c for c in curves if _of(c) == (*_of(first)[:-1], "")), None)
    if alone is None or np.log(max(1.0 - alone.explained, TINY) / max(1.0 - first.explained, TINY)) >= margin:
        return list(curves)
    return [alone, *(c for c in curves if c is not alone)]


def _with_body(study: Study, curves: Sequence[ScreenScore], count: int) -> list[ScreenScore]:
    """The first few free curves; with that of a drive's gain over the speed of the body that it drives also that body's friction.

    Both are forces on that body which change with its speed. Where the body's own curve explains about as much, refits have to decide.
    """
    first, driven = list(curves[:count]), driving_body(study.problem.model.all_ports)
    drives = {p.name for p in study.problem.model.all_ports if isinstance(p, Actuator)}
    gains = [c.explained for c in first if c.attachment.port in drives and _over_speed(c)]
    if driven is None or not gains:
        return first
    own = (c for c in curves[count:] if c.attachment.port == driven.name and _over_speed(c))
    return [*first, *(c for c in own if c.explained > study.settings.screen_tie * min(gains))]


def _with_parts(study: Study, curves: Sequence[ScreenScore], first: Sequence[ScreenScore]) -> list[ScreenScore]:
    """The ``first`` curves; with one over a part of a body's way also those of other bodies that explain nearly as much: all of them pass
    the place at once, and refits have to decide at which of them it acts.
    """
    most = max((c.explained for c in first if _over_part(c)), default=np.inf)
    near = (c for c in curves if _over_part(c) and c.explained > study.budget.part_at_other_bodies * most)
    return [*first, *(c for c in near if all(c is not one for one in first))]


def _over_part(curve: ScreenScore) -> bool:
    law = curve.attachment.mechanism
    return isinstance(law, Unknown) and bool(law.part)


def _of(curve: ScreenScore) -> tuple[str, str, str, str]:
    """The port of a free curve, its kind, the signal that it is drawn over, and what it is multiplied by ("" for nothing)."""
    law = curve.attachment.mechanism
    return curve.attachment.port, law.name, getattr(law, "signal", ""), getattr(law, "factor", "")


def _over_speed(score: ScreenScore) -> bool:
    return getattr(score.attachment.mechanism, "signal", "") == "speed"
