"""What an effect gains on experiments that had no part in choosing it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.along_free_runs import along_free_runs, free_run_states
from greybox_torch.diagnosis.confirm.along_travel import begun_along_travel
from greybox_torch.diagnosis.effect import Timeline
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, window_lengths
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.hypothesis.same_lengths import over_same_lengths
from greybox_torch.diagnosis.hypothesis.start_positions import placed, places_in
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator


@dataclass(frozen=True)
class Gain:
    """The share of the held-out squared error that an effect removes, its standard error over windows, and where along the experiments."""

    share: float
    error: float
    timelines: tuple[Timeline, ...] = ()
    size: float = float("nan")
    """Share of the plain model's held-out mismatch that leaving the effect out brings back."""
    untouched: bool = False
    """Whether nothing changes there without the effect, all else as it is, such as a limit that is never reached."""

    @property
    def errors_away(self) -> float:
        """How many standard errors the share lies above zero."""
        return self.share / max(self.error, 1e-12) if np.isfinite(self.error) else 0.0

    def unexercised(self, settings: DiagnosisSettings) -> bool:
        """Whether held-out experiments do not exercise the effect: with it and without it they come out alike."""
        return self.untouched or abs(self.share) + self.error < settings.unexercised

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the share, which is one at most."""
        return self.share - 1.96 * self.error, min(self.share + 1.96 * self.error, 1.0)


class HeldOut:
    """The validation experiments of a data set, and what hypotheses of a search leave there.

    ``problem`` is the plain model on them, outputs weighted as in the search. Fits are kept: confirming asks for some of them again.
    """

    def __init__(self, dataset: DataSet, study: Study) -> None:
        others = all_starts_free(dataset, make_problem(dataset, study.problem.model, dataset.validation()))
        self.problem = replace(others, weights=study.problem.weights, most_noise=study.problem.most_noise)
        self.study = study
        self._known: dict[Hypothesis, tuple[WindowFit, ...]] = {}

    def fits(self, hypothesis: Hypothesis) -> tuple[WindowFit, ...]:
        """The hypothesis with the parameters it was fitted with, as :func:`held_out_fits`."""
        if hypothesis not in self._known:
            self._known[hypothesis] = self.fits_at(hypothesis, hypothesis.values())
        return self._known[hypothesis]

    def places(self, hypothesis: Hypothesis) -> Places:
        """Where positions that no sensor shows begin, by experiment and state: as the windows have them, where those were fitted."""
        fits = self._known.get(hypothesis)
        return places_in(fits[-1].problem) if fits else NOWHERE

    def times_noise(self, hypothesis: Hypothesis) -> np.ndarray:
        """Root mean square errors in units of the noise, over the windows where they are largest, by experiment, shape (J,).

        Infinite where the hypothesis cannot be simulated at all.
        """
        squares = [_mean_squares(fit) for fit in self.fits(hypothesis)] or [
            np.full(len(self.problem.records.first), np.inf)
        ]
        return np.sqrt(np.max(squares, axis=0) / max(noise_floor(self.problem, self.study.settings), 1e-300))

    def errors(self, hypothesis: Hypothesis) -> tuple[np.ndarray, ...]:
        """Measured minus simulated over the longest windows, by experiment (n_y, N); none where it cannot be simulated there."""
        fits, records = self.fits(hypothesis), self.problem.records
        if not fits:
            return ()
        left = window_errors(fits[-1], self._simulator(hypothesis))
        return tuple(left[:, records.span(e)] for e in range(len(records.first)))

    def fits_at(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> tuple[WindowFit, ...]:
        """The hypothesis with other parameters."""
        return held_out_fits(hypothesis, self.problem, self._simulator(hypothesis), values, self.study.budget)

    def _simulator(self, hypothesis: Hypothesis) -> Simulator:
        """What the hypothesis is simulated with.

        Not with its own sub-steps: an earlier search may have taken others, and what is compared is simulated alike, but for what a law
        that is stiff asks for.
        """
        return hypothesis.simulator.with_substeps(self.study.options.substeps)


def held_out_fits(
    hypothesis: Hypothesis,
    problem: Problem,
    simulator: Simulator,
    values: Mapping[str, float],
    budget: SearchBudget,
) -> tuple[WindowFit, ...]:
    """The hypothesis on other experiments: parameters as they are, window start states free, at the middle and the longest windows.

    Args:
        problem: the plain model on the held-out experiments.
        simulator: of the hypothesis.
        values: parameter values by name.
    """
    known: Mapping[str, float] = {n: values[n] for n in hypothesis.problem.names}
    restated = (
        problem_for(problem, hypothesis.model, known)
        if hypothesis.effects
        else problem.with_values(np.array([values[n] for n in problem.names]))
    )
    started = estimate_initial(restated.fixed, simulator)
    started = begun_along_travel(started, simulator, range(len(started.records.first)))
    shortest, *longer = window_lengths(problem, budget)
    short = placed(started, simulator, shortest, budget) or along_free_runs(started, simulator, shortest, budget)
    if short is None or not longer:
        return () if short is None else (short,)
    found: list[WindowFit] = []
    for length in longer:
        there = placed(short.problem, simulator, length, budget, shorter=short) or short
        fit = partial(fit_windows, there.problem, simulator, length, settings=budget.window_iterations)
        begun = (partial(fit, shorter=there), partial(fit, shorter=short), fit)
        ended = reduce(_window_by_window, side_by_side(begun))
        ended = _no_worse_than_free_runs(ended, started, simulator, length, budget)
        if ended is not None:
            found.append(ended)
            short = replace(short, problem=ended.problem)
    return tuple(found)


def _window_by_window(one: WindowFit | None, other: WindowFit | None) -> WindowFit | None:
    """Of two fits of the start states the better one in every window: with the parameters fixed, windows are independent.

    From one start a window or two may end in a local minimum, which would outweigh all the others.
    """
    if one is None or other is None:
        return one or other
    better = other.energies < one.energies
    energies = np.where(better, other.energies, one.energies)
    share = float(energies.sum()) / max(float(one.energies.sum()), 1e-300)
    starts = np.where(better[:, None], other.starts, one.starts)
    return replace(one, starts=starts, energies=energies, mean_square=share * one.mean_square, along=None)


def _no_worse_than_free_runs(
    fit: WindowFit | None, started: Problem, simulator: Simulator, length: int, budget: SearchBudget
) -> WindowFit | None:
    """A fit, where free runs of the whole experiments pass through a window nearer to the measurements continued from there.

    Where friction holds, or a sensor is coarse, start states from the measurements of a window alone may end in a local minimum, beside
    which the model's own free run is right.
    """
    starts = None if fit is None else free_run_states(started, simulator, fit.windows)
    if fit is None or starts is None:
        return fit
    along = partial(fit_windows, fit.problem, simulator, length, starts=starts)
    there = along(settings=Settings(iterations=0))
    if there is None or (there.energies >= fit.energies).all():
        return fit
    return _window_by_window(fit, along(settings=budget.window_iterations))


def _mean_squares(fit: WindowFit) -> np.ndarray:
    """Mean squared weighted errors by experiment, shape (J,)."""
    records = fit.problem.records
    of = records.experiments(fit.windows.start)
    known = [int(np.sum(~np.isnan(records.y[:, records.span(e)]))) for e in range(len(records.first))]
    return np.bincount(of, weights=fit.energies, minlength=len(known)) / np.maximum(known, 1)


def gain(before: tuple[WindowFit, ...], after: tuple[WindowFit, ...]) -> Gain:
    """What ``after`` removes of the error of ``before``, at the window length where that is surest.

    The share is a ratio of sums over windows; its standard error is that of a ratio estimator (W. G. Cochran, Sampling Techniques, 1977).
    Where ``before`` cannot be simulated over any length that ``after`` can be, everything is gained. Seen: a knee's spring, without which
    short windows of a leg overflowed and the longest did not; what it removed of them was compared with those of another length, and it
    was taken back.
    """
    found, both = [], over_same_lengths(before, after)
    if after and not both:
        return Gain(1.0, 0.0)
    for old, new in both:
        count, total = len(old.energies), float(old.energies.sum())
        if count == len(new.energies) and total > 0:
            difference = old.energies - new.energies
            share = float(difference.sum()) / total
            scatter = float(np.std(difference - share * old.energies, ddof=1)) if count > 1 else np.inf
            found.append(Gain(share, float(scatter * np.sqrt(count) / total)))
    return max(found, key=lambda g: g.errors_away, default=Gain(0.0, float("inf")))


def pooled(gains: Sequence[Gain]) -> Gain:
    """The share that independent experiments show together, each by the inverse of its variance; none where no error is known.

    Source: W. G. Cochran, "The combination of estimates from different experiments", Biometrics 10, 1954.
    """
    known = [g for g in gains if np.isfinite(g.error)]
    weights = [1.0 / max(g.error, 1e-12) ** 2 for g in known]
    if not known:
        return Gain(0.0, float("inf"))
    share = sum(w * g.share for w, g in zip(weights, known, strict=True)) / sum(weights)
    return Gain(share, sum(weights) ** -0.5)


def timelines(before: tuple[WindowFit, ...], after: tuple[WindowFit, ...]) -> tuple[Timeline, ...]:
    """Where along the held-out experiments ``after`` removes error of ``before``: over the shortest windows that both could be fitted on.

    Windows in which the effect costs a little count as none.
    """
    both = over_same_lengths(before, after)
    if not both:
        return ()
    old, new = both[0]
    removed = np.maximum(old.energies - new.energies, 0.0)
    shares, records, windows = removed / max(float(removed.sum()), 1e-300), old.problem.records, old.windows
    of = records.experiments(windows.start)
    result = []
    for e, name in enumerate(records.names):
        time, first = records.time(e), int(records.first[e])
        edges = np.append(time[windows.start[of == e] - first], time[-1])
        result.append(Timeline(name, edges, shares[of == e]))
    return tuple(result)
