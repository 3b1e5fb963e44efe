"""The model as it stands, estimated from all experiments: what it explains so is no effect's doing.

From few experiments, a slow disturbance of one bends the parameters, free runs of the others drift, and an effect that takes up the
disturbance lets the parameters be right. Seen: a complete arm, told as a curve at its gearbox (0.93) that left 0.07 rad/s of 0.58 in an
experiment; estimated from all four, the model alone leaves 0.055 there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.longer_windows import explains_free_runs
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.free_run import FreeRun, descended
from greybox_torch.estimate.levenberg_marquardt import ROUGH
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import SimulationOptions, Simulator


def explained_without(study: Study, judged: Judgement) -> str:
    """That the model as it stands, estimated from all experiments, leaves less of free runs than the one with effects that was estimated
    from some of them, as a sentence; "" where it leaves more, or no free runs judge.
    """
    if judged.by_windows_alone:
        return ""
    study.working_on("estimating the model as it stands from all experiments")
    by_all = estimated_from_all(judged)
    if explains_free_runs(by_all, judged, study.settings, most=1.0):
        return ""
    _, times, experiment = by_all.left(False)
    return (
        f"Estimated from all experiments, the model as it stands leaves less in free runs ({times:.2g} times the noise at most, in "
        f"{experiment}) than with what was found over longer windows, which was taken back: the estimation experiments alone do not tell "
        "its parameters well enough to foretell the others. Estimate it from more of them."
    )


def estimated_from_all(judged: Judgement) -> Judgement:
    """The judgement of the model as it stands with the values that fit whole records of all experiments best, begun with those of the
    refit and with those that it has beside the effects; that of the refit where neither can be simulated.
    """
    whole, options = judged.problem, judged.free_runs.options
    begun = [
        _begun(whole, final.problem.values_by_name, comparison.initial)
        for final, comparison in ((judged.plain, judged.refit), (judged.augmented, judged.with_effects))
    ]
    fits = side_by_side([lambda p=p: _fitted(p, options) for p in begun])
    found = [fit for fit in fits if fit is not None]
    if not found:
        return Judgement.of(judged.free_runs, judged.plain)
    return Judgement.of(judged.free_runs, Final(min(found, key=lambda fit: fit[1])[0], None))


def _begun(whole: Problem, values: dict[str, float], starts: Sequence[np.ndarray]) -> Problem:
    """``whole`` with ``values`` by name and the first of the states (E, n) that free runs began with, which are its own."""
    own = np.array([values[name] for name in whole.names])
    return whole.with_values(own, np.array(starts)[:, : len(whole.model.states)])


def _fitted(problem: Problem, options: SimulationOptions) -> tuple[Problem, float] | None:
    """The problem at the optimum of whole records, and its cost; None where that cannot be simulated."""
    run = FreeRun(problem, fine_enough(Simulator.of(problem.model, problem.free_names, options), problem))
    optimum = descended(run, run.start, ROUGH)
    return None if optimum is None else (run.at(optimum.point), optimum.model.cost)
