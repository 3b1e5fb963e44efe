"""Which effects are offered to the next step, and what the screen says of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.screen.candidates import candidates, memory_candidates, periodic_candidates
from greybox_torch.diagnosis.screen.from_motion import candidates_from_motion
from greybox_torch.diagnosis.screen.part_of_the_way import curves_over_parts
from greybox_torch.diagnosis.screen.periodic_orders import distinct_orders, scan_orders
from greybox_torch.diagnosis.screen.score_test import Screen, ScreenScore
from greybox_torch.diagnosis.screen.screens import described
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of, shortlist
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body
from greybox_torch.simulation.side_by_side import side_by_side

Place = tuple[str, str]
"""A port and a signal there."""

Screened = tuple[tuple[ScreenScore, ...], ...]
"""By window length, the scores of effects."""


def screen_scores(study: Study, state: SearchState, *, curves: bool, fine: bool) -> Screened:
    """By window length, the scores of every effect that may join the hypothesis so far.

    Args:
        curves: whether free curves are offered.
        fine: offer curves with many knots, and nothing else.
    """
    offer_all(study, state, curves=curves, fine=fine)
    study.working_on("screening fine curves" if fine else "screening every port and mechanism")
    every = _fine_curves(study) if fine else _offered(study, state, curves)
    scored = _scored(study, state, every, state.current.fits)
    study.journal.screened(len(scored[0]) if scored else 0)
    return _with_narrow_curves(study, state, scored) if curves and not (fine or state.effects) else scored


def offer_all(study: Study, state: SearchState, *, curves: bool = True, fine: bool = False) -> None:
    """Note what a screen is to test, before it looks for periods: where it is stopped, all of that was not tried. Arguments as there."""
    any_order = [2.0 * study.settings.least_ripple_order]  # which orders is not known yet, and only names are noted
    every = _fine_curves(study) if fine else _with_periods(study, {"": any_order}, curves)
    study.journal.offer(a.named for a in every if _may_join(study, state, a))


def _with_narrow_curves(study: Study, state: SearchState, scored: Screened) -> Screened:
    """The scores and, where nothing explains nearly all, those of curves over positions that are fine enough for what acts along a part of
    the way, all along it and over that part alone, in the place of those with few knots which leave much more.

    Seen: two dips of a rail a thirtieth of the way long. A curve of few knots explained a half, a ripple of three harmonics more; neither
    held, and nothing was said to be missing. Beside named effects, which are never exact, forty knots always take up something: there fine
    curves are offered where nothing else pays.
    """
    best = max((s.explained for at_length in scored for s in at_length if np.isfinite(s.explained)), default=0.0)
    if best >= study.settings.screen_complete:
        return scored
    own = {q.name for q in study.problem.model.ports if isinstance(q, Body) and q.position is not None}
    along = [a for a in _fine_curves(study) if a.port in own and a.mechanism.signals() == ("position",)]
    study.working_on("screening fine curves along the way")
    most = study.settings.left_by_narrow
    for narrow in (
        _scored(study, state, along, state.current.fits),
        curves_over_parts(study, state.effects, state.current.fits),
    ):
        scored = tuple((*there, *_less_left(there, at, most)) for there, at in zip(scored, narrow, strict=True))
    return scored


def _less_left(there: Sequence[ScreenScore], narrow: Sequence[ScreenScore], most: float) -> list[ScreenScore]:
    """Those of the ``narrow`` curves that leave less than the part ``most`` of what any of the same signal that are ``there`` leave."""
    left: dict[tuple, float] = {}
    for s in (s for s in there if np.isfinite(s.explained)):
        identity = identity_of(s.attachment)
        left[identity] = min(1.0 - s.explained, left.get(identity, 1.0))
    return [s for s in narrow if 1.0 - s.explained < most * left.get(identity_of(s.attachment), 1.0)]


def from_card(study: Study, state: SearchState, *, curves: bool = True) -> list[Candidate]:
    """What the screen around the card's values suggests to join the model as it stands, where the fit of that is bent.

    Args:
        curves: whether free curves are offered.
    """
    if state.effects or not study.at_card:
        return []
    study.working_on("screening around the card's values")
    every = candidates(study.problem.model, study.shifts, study.surroundings, flexible=False)
    every += candidates(study.problem.model, study.shifts, study.surroundings, flexible=True) if curves else []
    return shortlist(study, _scored(study, state, every, study.at_card), study.at_card)


def place(attachment: Attachment) -> Place:
    """The port and the signal of a free curve or response."""
    return attachment.port, getattr(attachment.mechanism, "signal", "")


def memory_scores(study: Study, state: SearchState, knots: int = 0, among: Collection[Place] | None = None) -> Screened:
    """By window length, the scores of residuals with memory at every port; with ``knots``, of those with a curve in front.

    Args:
        among: the ports and signals asked; by default all.
    """
    study.working_on("screening residuals with memory")
    every = memory_candidates(study.problem.model, study.surroundings, knots)
    asked = [a for a in every if among is None or place(a) in among]
    return _scored(study, state, asked, state.current.fits)


def _scored(study: Study, state: SearchState, every: Sequence[Attachment], fits: Sequence[WindowFit]) -> Screened:
    """By window length, the scores of those that are not there yet, nor excluded, around ``fits`` of the effects that are."""
    model, at = study.problem.model, state.current
    offered = [a for a in every if _may_join(study, state, a)]
    if not offered:
        return tuple(() for _ in fits)
    around, free = study.surroundings, at.problem.free_names
    make = partial(Screen.of, model, at.effects, offered, around, free, study.options)
    screen = state.screens.showing(offered, make, study, at)
    asked = {described(a) for a in offered}
    scores = side_by_side(partial(screen.scores, fit) for fit in fits)
    return tuple(tuple(s for s in at_length if described(s.attachment) in asked) for at_length in scores)


def from_motion(study: Study, state: SearchState) -> list[Candidate]:
    """What the measured motion itself suggests to join the hypothesis so far.

    Nothing beside a free curve: with it the model is near the machine, where the screen is right, and its heights are too many to be
    estimated anew from the equations.
    """
    if state.has_curve:
        return []
    study.working_on("comparing the equations with the measured motion")
    return candidates_from_motion(
        study,
        state.current.problem,
        state.effects,
        partial(_may_join, study, state),
    )


def _may_join(study: Study, state: SearchState, offered: Attachment) -> bool:
    """Whether an effect is not there yet, and not excluded by what is known beforehand."""
    return not (_is_there(offered, state.effects) or study.beliefs.exclude(offered))


def _is_there(offered: Attachment, effects: tuple[Attachment, ...]) -> bool:
    """Whether an effect is in the hypothesis already, as itself, as a law that it contains or as a part of one."""
    there = {e.named for e in effects}
    there_in_part = {(e.port, name) for e in effects for name in e.mechanism.includes}
    own = {(offered.port, n) for n in (offered.mechanism.name, *offered.mechanism.generalises)}
    return bool(there & own) or offered.named in there_in_part


def _fine_curves(study: Study) -> list[Attachment]:
    knots = study.budget.fine_knots
    found = candidates(study.problem.model, study.shifts, study.surroundings, flexible=True, knots=knots)
    return [a for a in found if isinstance(a.mechanism, Unknown) and not a.mechanism.only_coarse]


def _offered(study: Study, state: SearchState, curves: bool) -> list[Attachment]:
    at = state.current
    over = [f for f in at.fits if f.mean_square > noise_floor(study.problem, study.settings)] or at.fits
    scanned = scan_orders(study, at.effects, at.problem.free_names, over[:2])
    first, *further = scanned or [""]
    known = [*scanned.get(first, ()), *orders_before(study, state)]
    orders = {first: distinct_orders(known, study.settings.orders_differ)}
    return _with_periods(study, {**orders, **{name: scanned[name] for name in further}}, curves)


def _with_periods(study: Study, orders: Mapping[str, Sequence[float]], curves: bool) -> list[Attachment]:
    """All laws, those that repeat with ``orders`` by the body that turns (the first of them by its usual name), and free curves."""
    model, shifts, surroundings = study.problem.model, study.shifts, study.surroundings
    periodic = partial(periodic_candidates, model, shifts, surroundings)
    least = study.settings.least_ripple_order
    first, *further = orders
    return [
        *candidates(model, shifts, surroundings, flexible=False),
        *periodic(orders[first], least),
        *(candidate for name in further for candidate in periodic(orders[name], least, at=name)),
        *(candidates(model, shifts, surroundings, flexible=True, knots=study.budget.knots) if curves else []),
    ]


def orders_before(study: Study, state: SearchState) -> list[float]:
    """Orders that refits of earlier steps came to: what is there now may hide the one that is right from a scan."""
    ranked = [r for done in state.steps for r in done.ranked if r.gain > study.settings.least_gain]
    values = ((r.fitted.values(), f"{r.candidate.attachment.prefix}.order") for r in ranked)
    return [found[name] for found, name in values if name in found]
