"""Over long windows, the start states before the parameters: where the motion is nearly chaotic, both at once lose what was found."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.diagnosis.hypothesis.continued import continued
from greybox_torch.diagnosis.hypothesis.noise import reaches_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.simulator import Simulator


def states_first(
    base: Problem,
    fit: WindowFit,
    fits: Sequence[WindowFit],
    simulator: Simulator,
    length: int,
    limits: Settings,
    settings: DiagnosisSettings,
    budget: SearchBudget,
) -> WindowFit:
    """``fit``, or a better one from the parameters that reached the noise over shorter windows, start states along those found first.

    Start states that are right over a fourth of a window may be too rough for the whole of it: then by way of half the length. Seen: an
    arm's play, found over windows of 312 samples; in one of four windows of 1248 the motion within the gap went another way, and a
    stiffness that varies was told in its place (0.97).

    Args:
        base: whose noise is to be reached.
        fits: over shorter windows, shortest first; the last reaches the noise.
    """
    best = fit
    for shorter in fits:
        best = min([best, *_along(shorter, fits[-1].problem, simulator, length, limits, budget)], key=_error)
    half = length // 2
    if reaches_noise(base, best, settings) or half <= fits[-1].windows.steps:
        return best
    half_way = fit_windows(fits[-1].problem.fixed, simulator, half, shorter=fits[-1], settings=limits)
    if half_way is None:
        return best
    return min([best, *_along(half_way, fits[-1].problem, simulator, length, limits, budget)], key=_error)


def _along(
    shorter: WindowFit, problem: Problem, simulator: Simulator, length: int, limits: Settings, budget: SearchBudget
) -> list[WindowFit]:
    """The fit whose start states were first estimated alone, beginning along those of ``shorter``; empty where none simulates."""
    begun = fit_windows(problem.fixed, simulator, length, shorter=shorter, settings=limits)
    again = begun and fit_windows(problem, simulator, length, starts=begun.starts, settings=limits)
    return [] if again is None else [continued(again, simulator, length, limits, budget)]


def _error(fit: WindowFit) -> float:
    return fit.mean_square
