"""Refitting a hypothesis: the model with its effects, on windows of several lengths."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.common_positions import begun_as, placed_alike, with_common_positions
from greybox_torch.diagnosis.hypothesis.continued import continued
from greybox_torch.diagnosis.hypothesis.implausible import implausibility
from greybox_torch.diagnosis.hypothesis.local_minima import no_worse_than_longer
from greybox_torch.diagnosis.hypothesis.noise import at_floor, floor_known, reaches_noise
from greybox_torch.diagnosis.hypothesis.states_first import states_first
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.estimate.rival import Rival
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.records import once
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.simulation.windows import Windows, cut


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A model with some effects attached, fitted; equal only to itself.

    With its simulator, which has tangents for the free parameters, and its window fits from short to long.
    """

    effects: tuple[Attachment, ...]
    model: GreyBoxModel
    simulator: Simulator
    fits: tuple[WindowFit, ...]
    floor: float
    """Mean squared weighted error below which nothing matters: 10⁻⁵ of the outputs' spread."""
    frozen: frozenset[str] = frozenset()
    """Parameters that were kept as they are though they are free."""
    implausible: float = 0.0
    """What the score of the model as it stands is worse for parameters that are orders of magnitude from the card's values.

    Where it leaves little more than noise: else what is missing shows. Not with effects, which may stand for what a parameter did."""

    @property
    def score(self) -> float:
        """Mean of the logarithms of the mean squared errors over the window lengths, and what is implausible; lower is better."""
        return score_of(self.fits, self.floor) + self.implausible

    def values(self) -> dict[str, float]:
        """Parameter values by name, from the longest windows."""
        return self.problem.values_by_name

    @property
    def problem(self) -> Problem:
        """The problem with the parameters of the longest windows."""
        return self.fits[-1].problem


def score_of(fits: Sequence[WindowFit], floor: float) -> float:
    """Mean of the logarithms of the mean squared errors of ``fits``."""
    return float(np.mean([np.log(f.mean_square + floor) for f in fits]))


def window_lengths(problem: Problem, budget: SearchBudget = SearchBudget()) -> list[int]:
    """Window lengths for a problem's records, in samples."""
    longest = int(problem.records.lengths.max())
    shortest = max(budget.shortest_window, round(longest / budget.windows_of_longest))
    return [shortest * factor for factor in budget.window_factors if shortest * factor <= longest // 2] or [shortest]


def hypothesis(
    base: Problem,
    effects: Sequence[Attachment],
    surroundings: Mapping[str, Surroundings],
    starts: Sequence[Mapping[str, float]],
    *,
    options: SimulationOptions,
    at: Sequence[int] | None = None,
    shorter: WindowFit | None = None,
    limits: Settings | None = None,
    settings: DiagnosisSettings = DiagnosisSettings(),
    budget: SearchBudget = SearchBudget(),
    simulator: Simulator | None = None,
    frozen: frozenset[str] = frozenset(),
    early: Sequence[Mapping[str, float]] = (),
    before: Hypothesis | None = None,
    beside: Hypothesis | None = None,
    absent: Mapping[str, float] = {},
    rough: bool = False,
    places: Places = NOWHERE,
) -> Hypothesis | None:
    """Fit ``base`` with ``effects`` attached, on windows of every length, from each of several start values; None where none simulates.

    At every length all the start values and the result of the length before get some iterations each; the best goes on to the end.

    Args:
        starts: parameter values by name, of the base and of the effects.
        early: further ones, for the shortest windows only.
        before: a rougher fit of the same effects with the same free parameters, which is carried on at the lengths that it has.
        beside: a fit of other effects. Over windows of every length but the shortest a trial begins with its values and start states: what
            short windows do not determine wanders off there, and start states of those do not lead back.
        absent: what the effects' parameters begin with there.
        at: window lengths; by default :func:`window_lengths`.
        limits: how far the best of the starts is followed; by default ``budget.window_iterations``.
        shorter: a fit on shorter windows that the start states are taken from.
        options: of the simulator, where none is given.
        simulator: one made for this model and these ``frozen`` parameters before.
        frozen: parameters that are to keep their start values.
        rough: whether the fit only chooses what is fitted further.
        places: where positions begin, where no fit knows it.
    """
    model = augmented(base, effects, surroundings)
    problems = [without_free(problem_for(base, model, start), frozen) for start in starts]
    first = [without_free(problem_for(base, model, start), frozen) for start in early]
    there = None if beside is None else without_free(problem_for(base, model, {**beside.values(), **absent}), frozen)
    simulator = simulator or Simulator.of(model, problems[0].free_names, options)
    limits, fits = limits or budget.window_iterations, []
    as_far = partial(_as_far_as_counts, base, limits, settings, budget, rough)
    at_end = partial(at_floor, base, settings=settings)
    at = at or window_lengths(base, budget)
    known_places = [*(() if before is None else before.fits[:1]), *(() if shorter is None else (shorter,))]
    problems, first = with_common_positions(problems, first, simulator, at[0], known_places, budget, rough, places)
    shorter = begun_as(problems[0], shorter)
    for length in at:
        known = None if before is None else _over(cut(base.records, length), before.fits)
        trials = _distinct([f.problem for f in fits[-1:]] + problems + ([] if fits else first), known)
        stood = None if beside is None or not fits else _over(cut(base.records, length), beside.fits)
        also = None if there is None or stood is None else (there, stood)
        fit = _best_fit(trials, known, simulator, length, shorter, as_far, at_end, budget, also)
        if fit is None:
            return None
        lost = fits and reaches_noise(base, fits[-1], settings) and not reaches_noise(base, fit, settings)
        fits.append(states_first(base, fit, fits, simulator, length, limits, settings, budget) if lost else fit)
        shorter = fits[-1]
    fits = no_worse_than_longer(fits, at, simulator, limits)
    hidden = not effects and all(reaches_noise(base, fit, settings, settings.far_above_noise) for fit in fits)
    implausible = implausibility(base, fits[-1].problem, settings) if hidden else 0.0
    # Kept by every hypothesis of a search, the last passes would take memory that nothing uses again.
    kept = tuple(fit if fit.ended is None else replace(fit, ended=None) for fit in fits)
    return Hypothesis(tuple(effects), model, simulator, kept, _floor(base, settings), frozen, implausible)


def without_free(problem: Problem, names: Collection[str]) -> Problem:
    """``problem`` with some parameters no longer free."""
    return replace(problem, free=problem.free & ~np.isin(problem.names, list(names)))


def augmented(base: Problem, effects: Sequence[Attachment], surroundings: Mapping[str, Surroundings]) -> GreyBoxModel:
    """The model of ``base`` with ``effects`` attached, the model itself where there are none."""
    return AugmentedModel(base.model, effects, surroundings) if effects else base.model


def _floor(base: Problem, settings: DiagnosisSettings) -> float:
    spread = once(base.records, "spread of each", lambda: np.nanstd(base.records.y, axis=1)) * base.weights
    return float(np.mean((settings.negligible_error * spread) ** 2)) + 1e-300


def _over(windows: Windows, fits: Sequence[WindowFit]) -> WindowFit | None:
    """The one of ``fits`` that is over these windows."""
    return next((fit for fit in fits if np.array_equal(fit.windows.start, windows.start)), None)


def _best_fit(
    trials: Sequence[Problem],
    known: WindowFit | None,
    simulator: Simulator,
    length: int,
    shorter: WindowFit | None,
    limits_of: Callable[[WindowFit], Settings],
    at_end: Callable[[WindowFit], bool],
    budget: SearchBudget,
    beside: tuple[Problem, WindowFit] | None = None,
) -> WindowFit | None:
    """The best that the trials lead to.

    Args:
        at_end: whether no other start could lead farther.
        beside: one more trial, and the fit that its start states come from.
    """
    begin = partial(fit_windows, simulator=simulator, length=length, shorter=shorter, settings=budget.first_iterations)
    leading, others = known, trials
    if known is None and trials:
        leading, others = begin(trials[0]), trials[1:]
    if leading is not None and at_end(leading):
        others = []
    rival = None if leading is None else Rival(leading.mean_square, budget.rival_pace)
    begun = [leading, *side_by_side(partial(begin, t, rival=rival) for t in others)]
    if beside is not None and others:
        problem, stood = beside
        begun.append(
            fit_windows(problem, simulator, length, shorter=stood, settings=budget.first_iterations, rival=rival)
        )
    found = sorted((fit for fit in begun if fit is not None), key=lambda f: f.mean_square)
    if not found:
        return None
    ended = side_by_side(
        partial(continued, fit, simulator, length, limits_of(fit), budget) for fit in _apart(found, budget)
    )
    return min(ended, key=lambda f: f.mean_square)


def _as_far_as_counts(
    base: Problem, limits: Settings, settings: DiagnosisSettings, budget: SearchBudget, rough: bool, fit: WindowFit
) -> Settings:
    """``limits`` with the tolerance that decisions can still see: at the noise all samples count, where more is left they do not."""
    if reaches_noise(base, fit, settings, settings.above_noise) or not floor_known(base, settings):
        return limits
    tolerance = budget.rough_mismatch_tolerance if rough else budget.mismatch_tolerance
    return replace(limits, tolerance=max(limits.tolerance, tolerance))


def _apart(found: Sequence[WindowFit], budget: SearchBudget) -> list[WindowFit]:
    """The best, and the next one that seems to be on its way to another optimum: being ahead early says little."""
    best = found[0]
    values = best.problem.values
    rivals = [
        f
        for f in found[1:]
        if f.mean_square < budget.rival_start * best.mean_square
        and not np.allclose(f.problem.values, values, rtol=0.02)
    ]
    return [best, *rivals[:1]]


def _distinct(problems: Sequence[Problem], known: WindowFit | None) -> list[Problem]:
    """Those that are admissible and begin where no other does, nor ``known`` has led."""
    kept: list[Problem] = [] if known is None else [known.problem]
    for p in problems:
        if p.admissible(p.values) and not any(_begin_alike(p, q) for q in kept):
            kept.append(p)
    return kept if known is None else kept[1:]


def _begin_alike(one: Problem, other: Problem) -> bool:
    return np.allclose(one.values, other.values, rtol=1e-3, atol=0) and placed_alike(one, other)
