"""A fit of the model as it stands that moves some signal, or a parameter, far from the card's values: bent, not the machine.

What is missing may be made up for by parameters that no machine has: a drill string's spring a fortieth as stiff, behind which a bit
that nobody measures rings at fifteen times the speed of the drive. Around such a fit the screen sees nothing of the bit's friction, and the
ranges that bound its law are wrong. So both are taken from where the user began, too. So they are where a parameter is a small part, or
many times, of what the user began with: a lift's car that has a hundredth of its mass, for its rope is stiffer the higher it is. And a law
with which a fit is bent goes after one that needs no such thing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, window_lengths
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.estimate.window_fit import WindowFit, fit_windows, states_along
from greybox_torch.mechanisms.mechanism import Range, Surroundings

Ranges = Mapping[str, Surroundings]


def from_the_card(study: Study, plain: Hypothesis) -> tuple[tuple[WindowFit, ...], Ranges | None]:
    """The windows of ``plain`` with the card's parameter values, start states estimated, and the ranges of the signals there.

    No windows, and no ranges, where the simulation overflows.
    """
    fits: list[WindowFit] = []
    for length, fitted in zip(window_lengths(study.problem, study.budget), plain.fits, strict=True):
        limits = study.budget.first_iterations
        found = fit_windows(study.problem.fixed, plain.simulator, length, settings=limits)
        if found is None:
            return (), None
        fits.append(replace(found, problem=replace(found.problem, free=fitted.problem.free)))
    over = fits[min(1, len(fits) - 1)]
    return tuple(fits), surroundings_along(study.problem.model, over.problem, states_along(over, plain.simulator))


def narrowed(found: Ranges, at_card: Ranges, farther: float) -> dict[str, Surroundings]:
    """``found`` with the card's range for every signal that moves so many times ``farther`` than there.

    A signal that does not exist there keeps its range: what drives and brakes a body depends on which way it turns.
    """

    def of(name: str, range_: Range, there: Surroundings) -> Range:
        other = there.ranges.get(name)
        return other if other is not None and range_.reach > farther * other.reach and other.rms > 0 else range_

    return {
        port: replace(around, ranges={n: of(n, r, at_card[port]) for n, r in around.ranges.items()})
        for port, around in found.items()
    }


def moved_far(problem: Problem, times: float) -> bool:
    """Whether some free parameter is more than so many ``times`` what it began as, or less than such a part; zero is no such part: what a
    machine does not have may go.
    """
    began, here = np.abs(problem.expected[problem.free]), np.abs(problem.values[problem.free])
    known = (began > 0.0) & (here > 0.0)
    return bool((np.abs(np.log(here[known] / began[known])) > np.log(times)).any())


def unbent_first(ranked: Sequence[RankedCandidate], settings: DiagnosisSettings) -> list[RankedCandidate]:
    """``ranked`` with the first name before a leading one that is bent, if it is not and comes nearly as far.

    A law in a wrong place can do as much where a part of the machine is given up for it. Seen: the viscous friction of an arm, told at its
    gearbox (0.97), with the spring between the two thirty thousand times softer than on the card.
    """

    def bent(r: RankedCandidate) -> bool:
        return moved_far(r.fitted.problem, settings.bent_parameter)

    if not ranked or ranked[0].unknown or not bent(ranked[0]):
        return list(ranked)
    least = settings.unbent_share * ranked[0].gain
    whole = next((r for r in ranked if not r.unknown and r.gain >= least and not bent(r)), ranked[0])
    return [whole, *(r for r in ranked if r is not whole)]
