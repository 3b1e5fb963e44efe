"""The final fits: whole records, from the values that the windows led to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import noise_over_windows
from greybox_torch.diagnosis.hypothesis.beside_curves import beside_curves, weights_of_curves, windows_beside_curves
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.steps_of_whole_records import in_steps_for_whole_records
from greybox_torch.diagnosis.hypothesis.weights_of_outputs import weighed_by_what_is_left
from greybox_torch.diagnosis.hypothesis.whole_records import coloured, whole_runs
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.free_run import FreeRun, descended
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.returned import returned
from greybox_torch.estimate.through_windows import from_windows
from greybox_torch.estimate.uncertainty import Uncertainty, of_information, uncertainty
from greybox_torch.estimate.window_information import uncertainty_over_windows
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.side_by_side import side_by_side


@dataclass(frozen=True)
class Final:
    """A hypothesis fitted to whole estimation records: its problem there, and the uncertainty of the unknowns (None where unfitted).

    ``weighed``: with errors weighed by their spectrum. ``of_windows``: its values are those of the longest windows, see
    :func:`as_windows_have_it`. ``with_curves`` makes the same with the weights of free curves among the unknowns,
    None where there are none.
    """

    problem: Problem
    uncertainty: Uncertainty | None
    weighed: bool = False
    of_windows: bool = False
    with_curves: Callable[[], Final | None] | None = None

    @cached_property
    def told(self) -> Final:
        """The one whose deviations a reader is told, which allow for what is not known of free curves."""
        return (None if self.with_curves is None else self.with_curves()) or self

    def sentences(self) -> tuple[str, ...]:
        """What the reader of a verdict has to know of it."""
        told = (
            "Whole records of the model with effects were fitted with errors weighed by their spectrum: over windows hardly more than "
            "noise is left, what a free run leaves beyond that is slow, and plain least squares would bend the parameters to it."
        )
        return (told,) if self.weighed else ()

    def values(self) -> dict[str, float]:
        """Parameter values by name."""
        return self.problem.values_by_name

    def deviations(self) -> dict[str, float]:
        """Standard deviation of every free parameter: the larger of the plain and the sandwich one."""
        if self.uncertainty is None:
            return {}
        both = np.maximum(self.uncertainty.deviations("plain"), self.uncertainty.deviations("sandwich"))
        return dict(zip(self.problem.free_names, map(float, both), strict=False))


def finish(
    hypothesis: Hypothesis,
    settings: DiagnosisSettings = DiagnosisSettings(),
    budget: SearchBudget = SearchBudget(),
    records: Records | None = None,
) -> Final:
    """Fit whole records by simulation error, from the values of every window length and from the card's; the best of the results.

    Where the effects of a hypothesis leave noise alone over windows, what a free run leaves beyond it is a slow disturbance, and the errors
    are weighed by their spectrum. (The model as it stands is always fitted to simulation error: the best that it can do.) Elsewhere each of
    several outputs is weighed by what is left of it, see :func:`weighed_by_what_is_left`.

    Where no whole record can be simulated, the values of the longest windows stand. Steps are those that free runs need, see
    :func:`in_steps_for_whole_records`.

    Args:
        records: of the same experiments, the first sample of each the same; by default those that the hypothesis was found on.
    """
    hypothesis = in_steps_for_whole_records(hypothesis, settings)
    problems = [from_windows(fit) for fit in reversed(hypothesis.fits)]
    runs = whole_runs(hypothesis, [*problems, _from_the_card(hypothesis)])
    begun = side_by_side(partial(descended, run, run.start, budget.record_first_iterations) for run in runs)
    best, cost = None, np.inf
    for run, optimum in zip(runs, begun, strict=True):
        if optimum is not None and optimum.model.cost < (1 - 1e-3) * cost:
            best, cost = (run, optimum.point), optimum.model.cost
    if best is None:
        return from_longest_windows(hypothesis)
    run, point = best
    if hypothesis.effects and noise_over_windows(hypothesis, settings):
        weighed = _weighed(hypothesis, [run.at(point), runs[0].problem], records)
        if weighed is not None:
            return weighed
    if records is not None:
        run = _on_all(hypothesis, records, run.problem)
    ended = descended(run, point, budget.record_iterations)
    point = point if ended is None else ended.point
    run, point = weighed_by_what_is_left(run, point, budget.record_iterations)
    point = returned(run, point)
    # What compares hypotheses goes by the weights that all of them share.
    shared = replace(run.at(point), weights=hypothesis.problem.weights)
    return Final(shared, uncertainty(run, point), with_curves=_with_curves(hypothesis, run.at(point)))


def _weighed(hypothesis: Hypothesis, begun: Sequence[Problem], records: Records | None) -> Final | None:
    """The likeliest fit with errors weighed by their spectrum, from several beginnings; None where none can be simulated.

    The way there needs no more samples than the search: those of ``records`` tell the end of it.
    """
    # a run keeps where its stretches began: those fitted side by side are objects of their own
    found = coloured(whole_runs(hypothesis, begun))
    if found is not None and records is not None:
        run, fit = found
        found = coloured([_on_all(hypothesis, records, run.at(fit.point))])
    if found is None:
        return None
    run, fit = found
    at, known = run.at(fit.point), of_information(fit.information, by_samples=True)
    return Final(at, known, weighed=True, with_curves=_with_curves(hypothesis, at, weighed=True))


def _with_curves(hypothesis: Hypothesis, at: Problem, weighed: bool = False) -> Callable[[], Final | None] | None:
    """Makes a fit with the weights of free curves among the unknowns, once it is told; None where there are none."""

    def made() -> Final | None:
        found = beside_curves(hypothesis, at, weighed=weighed)
        return None if found is None else Final(*found, weighed=weighed)

    return made if weights_of_curves(hypothesis).any() else None


def from_longest_windows(hypothesis: Hypothesis) -> Final:
    """The values of the longest windows, as if no whole record could be simulated."""
    return Final(from_windows(hypothesis.fits[-1]), None, of_windows=True)


def as_windows_have_it(
    hypothesis: Hypothesis, settings: DiagnosisSettings = DiagnosisSettings(), records: Records | None = None
) -> Final:
    """The values of the longest windows, with the uncertainty that they have there, and in the steps of :func:`finish`.

    Where they are asked for, whole records are no measure of the values: a run that is lost says nothing of what its error depends on.
    """
    hypothesis = in_steps_for_whole_records(hypothesis, settings)
    problem = from_windows(hypothesis.fits[-1])
    run = whole_runs(hypothesis, [problem])[0] if records is None else _on_all(hypothesis, records, problem)
    at = run.at(run.start)
    # Whole records take the weights of curves as known: the windows have them among their unknowns.
    known = uncertainty_over_windows(hypothesis.fits[-1], hypothesis.simulator, names=at.free_names)

    def with_curves() -> Final | None:
        found = windows_beside_curves(hypothesis, at)
        return None if found is None else Final(*found, of_windows=True)

    return Final(at, known, of_windows=True, with_curves=with_curves if weights_of_curves(hypothesis).any() else None)


def _on_all(hypothesis: Hypothesis, records: Records, problem: Problem) -> FreeRun:
    """The run of a problem on other samples of the same experiments."""
    return whole_runs(hypothesis, [replace(problem, records=records)])[0]


def _from_the_card(hypothesis: Hypothesis) -> Problem:
    """The problem of the longest windows with the machine's own parameters as the card has them: windows may lead to another valley."""
    problem = from_windows(hypothesis.fits[-1])
    added = [any(name.startswith(f"{e.prefix}.") for e in hypothesis.effects) for name in problem.names]
    return problem.with_values(np.where(added, problem.values, problem.expected))
