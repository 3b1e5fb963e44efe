"""Other values of the model as it stands, where what was found leaves more than noise: they may be all that is wrong."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise, times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, window_lengths
from greybox_torch.diagnosis.select.plain_model import fit_plain_model
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.free_run import visited_states
from greybox_torch.estimate.global_search import look_around
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulation.windows import cut


def other_values(study: Study, state: SearchState) -> tuple[Study, SearchState] | None:
    """The study and the state to begin from, with values far from those of the plain fit; None where none leave less than what was found.

    A fit over windows from the card's values may end in a local minimum, and effects are then found that make up for it. Free runs from
    many start values find the others. Seen: a wrist with a harmonic drive that lacks nothing, told as missing something at 24 times the
    noise, for the phase of its gear's error.
    """
    settings, problem = study.settings, study.problem
    if not problem.free.any() or times_noise(problem, state.current, settings) <= settings.above_noise:
        return None
    study.working_on("looking for other parameter values of the model as it stands")
    simulator = simulator_for(problem, study.options)
    found = look_around(problem, simulator, starts=study.budget.other_values, turns=1)
    if found is None:
        return None
    begun = _along_free_runs(study, found.problem)
    study, other = fit_plain_model(study, begun)
    return (study, other) if _leaves_less(problem, other.plain, state, study) else None


def _along_free_runs(study: Study, problem: Problem) -> WindowFit:
    """The shortest windows, each beginning where the free run passes: rough start states would lead a fit out of the valley again."""
    states = np.concatenate(visited_states(problem, simulator_for(problem, study.options)))
    windows = cut(problem.records, window_lengths(problem, study.budget)[0])
    return WindowFit(problem, windows, states[windows.start], float("inf"), np.zeros(len(windows.start)), 0)


def _leaves_less(problem: Problem, plain: Hypothesis, state: SearchState, study: Study) -> bool:
    """Whether the model as it stands leaves clearly less there than what was found, with its effects, or noise alone."""
    return only_noise(problem, plain, study.settings) or plain.score < state.current.score - study.settings.curve_margin
