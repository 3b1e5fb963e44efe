"""From the scores of a screen to the few hypotheses worth a refit."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.screen.first_few import first_few
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings


@dataclass(frozen=True)
class Candidate:
    """A hypothesis worth a refit: the attachment, the start values that the screen suggests, and the largest share it explained."""

    attachment: Attachment
    starts: tuple[dict[str, float], ...]
    explained: float
    from_motion: tuple[dict[str, float], ...] = ()
    """Further start values, which the measured motion suggests."""
    steps: int = 0
    """Samples of the longest of the windows over which the screen saw it explain most; zero where no screen saw it."""
    found_before: tuple[dict[str, float], ...] = ()
    """Values that a search with fewer experiments came to, which come before all others."""
    absent: Mapping[str, float] = field(default_factory=dict)
    """Its parameters with no size: the model without it. Empty for a law that has no amplitude."""
    at_card: tuple[dict[str, float], ...] = ()
    """Start values that the screen around the card's values suggests, where the model as it stands is bent."""
    begun: WindowFit | None = None
    """What its windows take their first start states from: by default the hypothesis before it."""
    ahead: bool = False
    """Whether it is to stand before the other laws at its actuator rather than behind them."""

    def first_starts(self, count: int) -> tuple[dict[str, float], ...]:
        """The first ``count`` of the screen's start values, those of the measured motion, and before them what was found before."""
        return (*self.found_before, *self.starts[:count], *self.from_motion)

    @property
    def unknown(self) -> bool:
        """Whether it is a free curve or response."""
        return self.attachment.mechanism.free


def shortlist(study: Study, screened: Sequence[Sequence[ScreenScore]], fits: Sequence[WindowFit]) -> list[Candidate]:
    """The best candidates at any window length, each with start values from every length at which it leads.

    A model that lacks an effect bends its parameters to make up for it, at times into a valley that the complete model cannot leave again;
    so every candidate is also refitted from where the user began.

    Args:
        screened: per window length, the scores of the screen.
        fits: per window length, the fit that was screened.
    """
    return _followed(study, screened, fits, partial(first_few, study))


def at_other_ports(
    study: Study,
    attachment: Attachment,
    known: Collection[Attachment],
    screened: Sequence[Sequence[ScreenScore]],
    fits: Sequence[WindowFit],
) -> list[Candidate]:
    """A law, and the laws that it contains, at every port where it was screened, without those ``known``.

    Arguments as for :func:`shortlist`. A score is linear: where an effect is large, another place than the right one may explain more of it
    at first sight.
    """
    names = {attachment.mechanism.name, *attachment.mechanism.generalises}
    there = {identity_of(a) for a in known}

    def not_known(best: list[ScreenScore]) -> list[ScreenScore]:
        return [b for b in best if b.attachment.mechanism.name in names and identity_of(b.attachment) not in there]

    return _followed(study, screened, fits, not_known)


def _followed(
    study: Study,
    screened: Sequence[Sequence[ScreenScore]],
    fits: Sequence[WindowFit],
    choose: Callable[[list[ScreenScore]], list[ScreenScore]],
) -> list[Candidate]:
    """What ``choose`` takes of the scores at any window length, best of each hypothesis first, as candidates."""
    surroundings, card = study.surroundings, study.card
    found: dict[tuple, Candidate] = {}
    for at_length, fit in zip(screened, fits, strict=True):
        fitted = fit.problem.values_by_name
        for score in choose(best_of_each(at_length, surroundings)):
            if score.explained < study.settings.least_screen_share:
                continue
            identity = identity_of(score.attachment)
            shape = suggested(score, surroundings)
            starts = ({**fitted, **card, **shape}, {**fitted, **shape})
            if getattr(score.attachment.mechanism, "knots", 0):
                starts = (starts[1], {**fitted, **_scaled(score, shape, study.budget.part_of_curve)}, starts[0])
            own = Candidate(
                score.attachment,
                starts,
                score.explained,
                steps=score.length,
                absent=_scaled(score, shape, 0.0),
            )
            before = found.get(identity)
            if before is None:
                found[identity] = own
                continue
            better, other = (own, before) if score.explained > before.explained else (before, own)
            alike = _knots(better.attachment) == _knots(other.attachment)
            found[identity] = replace(better, starts=(*better.starts, *other.starts)) if alike else better
    return sorted(found.values(), key=lambda candidate: -candidate.explained)


def _knots(attachment: Attachment) -> tuple[int, tuple[float, float] | None]:
    """How many knots a curve has, and over what part: the heights of others are those of another force. Alike for all laws."""
    mechanism = attachment.mechanism
    return getattr(mechanism, "knots", 0), getattr(mechanism, "part", None)


def with_substeps(candidate: Candidate, count: int) -> Candidate:
    """The candidate, simulated with so many Runge-Kutta steps per sample at the least."""
    return replace(candidate, attachment=replace(candidate.attachment, substeps=count))


def with_motion(found: Sequence[Candidate], from_motion: Sequence[Candidate]) -> list[Candidate]:
    """Candidates of the screen, with further start values that the measured motion gives some of them, and what it adds to them."""
    added = {identity_of(c.attachment): c for c in from_motion}
    both = []
    for candidate in found:
        further = added.pop(identity_of(candidate.attachment), None)
        starts = () if further is None else further.starts
        both.append(replace(candidate, from_motion=(*candidate.from_motion, *starts)))
    return [*both, *added.values()]


def with_card(found: Sequence[Candidate], at_card: Sequence[Candidate]) -> list[Candidate]:
    """Candidates of the screen, with start values that it suggests around the card's values, and what it shows there beside them."""
    there = {identity_of(c.attachment): replace(c, at_card=c.starts) for c in at_card}
    both = [replace(c, at_card=there.pop(identity_of(c.attachment), c).at_card) for c in found]
    return [*both, *there.values()]


def contains(law: Attachment, other: Attachment) -> bool:
    """Whether a law contains another one at its port (``generalises``): not itself, as stops at both ends contain those at one."""
    inside = law.port == other.port and other.mechanism.name in law.mechanism.generalises
    return inside and identity_of(law) != identity_of(other)


def identity_of(attachment: Attachment) -> tuple:
    """What makes two attachments the same hypothesis."""
    mechanism = attachment.mechanism
    order = getattr(mechanism, "order", None)
    return (
        attachment.port,
        mechanism.name,
        attachment.label,
        getattr(mechanism, "signal", ""),
        getattr(mechanism, "factor", ""),
        getattr(mechanism, "modes", 0),
        getattr(mechanism, "power", 0),
        getattr(mechanism, "both", False),
        None if order is None else round(order, 2),
    )


def best_of_each(scores: Sequence[ScreenScore], surroundings: Mapping[str, Surroundings]) -> list[ScreenScore]:
    """Of every hypothesis the probe that explains most, with a size that its law allows; best first."""
    best: dict[tuple, ScreenScore] = {}
    for score in scores:
        identity = identity_of(score.attachment)
        before = best[identity].explained if identity in best else -np.inf
        if np.isfinite(score.explained) and score.explained > before and _physical(score, surroundings):
            best[identity] = score
    return sorted(best.values(), key=lambda score: -score.explained)


def _physical(score: ScreenScore, surroundings: Mapping[str, Surroundings]) -> bool:
    """Whether the estimated size has the sign that the law allows (at least one of several directions)."""
    bounds = {p.name: p.bounds for p in score.attachment.mechanism.parameters(surroundings[score.attachment.port])}
    bounds[SHARE] = (0.0, np.inf)
    inside = [
        bounds[name][0] <= size <= bounds[name][1]
        for name, size in zip(score.probe.directions, score.size, strict=True)
    ]
    return any(inside)


def _scaled(score: ScreenScore, suggested: Mapping[str, float], part: float) -> dict[str, float]:
    """The suggested values with a part of the amplitudes; nothing where the law has none."""
    sizes = {f"{score.attachment.prefix}.{n}" for n in score.probe.directions if n != SHARE}
    return {n: part * v if n in sizes else v for n, v in suggested.items()} if sizes else {}


def suggested(score: ScreenScore, surroundings: Mapping[str, Surroundings]) -> dict[str, float]:
    """Parameters of an effect by their full names, as its score suggests them, within their bounds."""
    prefix = score.attachment.prefix
    values = dict(score.probe.values)
    values |= {n: float(v) for n, v in zip(score.probe.directions, score.size, strict=True) if n != SHARE}
    bounds = {p.name: p.bounds for p in score.attachment.mechanism.parameters(surroundings[score.attachment.port])}
    return {f"{prefix}.{name}": float(np.clip(value, *bounds[name])) for name, value in values.items()}
