"""Held-out experiments judge the effects that the estimation experiments chose, and may take them back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from greybox_torch.data import DataSet
from greybox_torch.diagnose.choice import LEAST_SURENESS
from greybox_torch.diagnose.held_out import Gain, gain, held_out_fits, timelines
from greybox_torch.diagnose.refit import Hypothesis
from greybox_torch.diagnose.select import Search
from greybox_torch.diagnose.sureness import likelihood_ratio
from greybox_torch.estimate.problem import all_starts_free, make_problem
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulate.side_by_side import side_by_side

LEAST_HELD_OUT = 1.0
"""Standard errors by which an effect must lower the error on held-out experiments to be kept."""

BEYOND_CHANCE = 3.0
"""Standard errors by which a free curve must beat named effects on held-out experiments, or a law one that it contains, to be preferred."""

UNEXERCISED = 2e-3
"""Share of the held-out error below which, either way, those experiments do not exercise an effect: they cannot take it back."""


def confirmed(dataset: DataSet, search: Search, progress: Callable[[str], None]) -> dict[str, Gain]:
    """Held-out gains by effect, after taking back, weakest first, every effect that gains nothing there."""
    if not dataset.validation() or not search.current.effects:
        return {}
    progress("confirming on held-out experiments")
    search.progress = progress
    problem = all_starts_free(dataset, make_problem(dataset, search.problem.model, dataset.validation()))
    if search.named is not None:
        named, curve = (held_out_fits(h, problem, search.substeps) for h in (search.named[0], search.current))
        if gain(named, curve).errors_away < BEYOND_CHANCE:
            search.settle_for_named()
    on_others = partial(held_out_fits, problem=problem, substeps=search.substeps)
    _simplified(search, on_others)
    while search.current.effects:
        full, *without = side_by_side(partial(on_others, h) for h in (search.current, *search.without.values()))
        gains = {
            p: replace(gain(fits, full), timelines=timelines(fits, full))
            for p, fits in zip(search.without, without, strict=True)
        }
        weakest = min(gains, key=lambda p: gains[p].errors_away)
        found = gains[weakest]
        if found.errors_away > LEAST_HELD_OUT or abs(found.share) + found.error < UNEXERCISED:
            return gains
        search.drop(weakest)
    return {}


def _simplified(search: Search, on_others: Callable[[Hypothesis], tuple[WindowFit, ...]]) -> None:
    """Take the law that an effect's law contains instead, where the larger one predicts other experiments no better."""
    for effect in search.current.effects:
        for rival, simpler in search.contained(effect):
            before, after = side_by_side(partial(on_others, h) for h in (simpler, search.current))
            no_farther = gain(before, after).errors_away < BEYOND_CHANCE
            if no_farther and likelihood_ratio(simpler, search.current) < LEAST_SURENESS:
                search.settle_for(rival, simpler, effect)
                break


def without_weakest(search: Search, gains: Mapping[str, Gain]) -> dict[str, Gain]:
    """Take back the effect that gained least on held-out experiments (the newest where that is not known); the gains of the others."""
    names = [e.prefix for e in search.current.effects]
    weakest = min(names, key=lambda n: gains[n].share) if all(n in gains for n in names) else names[-1]
    search.drop(weakest)
    left = {e.prefix for e in search.current.effects}
    return {n: g for n, g in gains.items() if n in left}
