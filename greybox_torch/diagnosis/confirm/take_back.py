"""Held-out experiments judge the effects that the estimation experiments chose, and may take them back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain, timelines
from greybox_torch.diagnosis.hypothesis.significance import likelihood_ratio
from greybox_torch.diagnosis.select.choice import LEAST_SIGNIFICANCE
from greybox_torch.diagnosis.select.search import Search
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulation.side_by_side import side_by_side

LEAST_HELD_OUT = 1.0
"""Standard errors by which an effect must lower the error on held-out experiments to be kept."""

BEYOND_CHANCE = 3.0
"""Standard errors by which a free curve must beat named effects on held-out experiments, or a law one that it contains, to be preferred."""

LEAST_OWN = 3.0
"""Standard errors by which leaving an effect out of held-out experiments, all else as it is, must raise the error there."""

PARTLY = 0.9
"""Share of the held-out error below which it is asked whether an effect itself removes it."""

UNEXERCISED = 2e-3
"""Share of the held-out error below which, either way, those experiments do not exercise an effect: they cannot take it back."""


def confirmed(search: Search, others: HeldOut | None, progress: Callable[[str], None]) -> dict[str, Gain]:
    """Held-out gains by effect, after taking back, weakest first, every effect that gains nothing there."""
    if others is None or not search.current.effects:
        return {}
    progress("confirming on held-out experiments")
    search.progress = progress
    if search.named is not None:
        named, curve = (others.fits(h) for h in (search.named[0], search.current))
        if gain(named, curve).errors_away < BEYOND_CHANCE:
            search.settle_for_named()
    _simplified(search, others)
    while search.current.effects:
        full, *without = side_by_side(partial(others.fits, h) for h in (search.current, *search.without.values()))
        gains = {
            p: replace(gain(fits, full), timelines=timelines(fits, full))
            for p, fits in zip(search.without, without, strict=True)
        }
        weakest = min(gains, key=lambda p: gains[p].errors_away)
        if not _borne_out(gains[weakest]):
            search.drop(weakest)
        elif (idle := _idle(search, gains, full, others)) is not None:
            search.drop(idle)
        else:
            return gains
    return {}


def _borne_out(gain: Gain, least: float = LEAST_HELD_OUT) -> bool:
    """Whether held-out experiments bear an effect out by so many standard errors, or do not exercise it."""
    return gain.errors_away > least or abs(gain.share) + gain.error < UNEXERCISED


def _idle(search: Search, gains: Mapping[str, Gain], full: tuple[WindowFit, ...], others: HeldOut) -> str | None:
    """An effect that gains on held-out experiments only by what the other parameters became beside it, if there is one.

    A disturbance of one experiment (a slow drift) bends the other parameters; what takes it up there, say a bias, frees them, and so
    predicts other experiments better though it is not in them. Left out there, all else as it is, nothing is lost.
    """
    values = search.current.values()
    for prefix in (p for p, found in gains.items() if found.share < PARTLY):
        own = gain(others.fits_at(search.without[prefix], values), full)
        if not _borne_out(own, LEAST_OWN):
            return prefix
    return None


def _simplified(search: Search, others: HeldOut) -> None:
    """Take the law that an effect's law contains instead, where the larger one predicts other experiments no better."""
    for effect in search.current.effects:
        for rival, simpler in search.contained(effect):
            before, after = side_by_side(partial(others.fits, h) for h in (simpler, search.current))
            no_farther = gain(before, after).errors_away < BEYOND_CHANCE
            if no_farther and likelihood_ratio(simpler, search.current) < LEAST_SIGNIFICANCE:
                search.settle_for(rival, simpler, effect)
                break


def without_weakest(search: Search, gains: Mapping[str, Gain]) -> dict[str, Gain]:
    """Take back the effect that gained least on held-out experiments (the newest where that is not known); the gains of the others."""
    names = [e.prefix for e in search.current.effects]
    weakest = min(names, key=lambda n: gains[n].share) if all(n in gains for n in names) else names[-1]
    search.drop(weakest)
    left = {e.prefix for e in search.current.effects}
    return {n: g for n, g in gains.items() if n in left}
