"""What was found, simulated in finer steps where it is stiff."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.estimate.through_windows import from_windows
from greybox_torch.mechanisms.attachment import Attachment


def in_finer_steps(study: Study, state: SearchState) -> SearchState:
    """The state with its newest effect simulated :func:`finely_enough`."""
    if not state.effects:
        return state
    newest = next(e for e in state.effects if e.prefix == state.newest)
    again = finely_enough(study, state.current, newest)
    return state if again is state.current else state.at(again)


def finely_enough(study: Study, fitted: Hypothesis, law: Attachment) -> Hypothesis:
    """A hypothesis refitted with as many Runge-Kutta steps per sample for one law as its values ask for, where it is much better so.

    Steps that do for the model as it stands may be too coarse for what is found: the fit then ends where the next better value would be
    unstable, and what is left is error of the integration. Seen: a hydraulic slide whose dry friction changes its sign within 1 mm/s, told
    as 1.6 mm/s with 17 times the noise left; four steps instead of one left noise alone. Nothing is asked where hardly more than noise is
    left, and they have to bring much, for every later pass takes as many times as long.
    """
    if times_noise(study.problem, fitted, study.settings) <= study.settings.above_noise:
        return fitted
    asked = fine_enough(fitted.simulator, from_windows(fitted.fits[-1])).substeps
    if asked <= fitted.simulator.substeps:
        return fitted
    effects = tuple(replace(e, substeps=asked) if e.prefix == law.prefix else e for e in fitted.effects)
    study.working_on("simulating in finer steps")
    again = fit(study, effects, [fitted.values()], fitted.fits[0], limits=study.budget.window_iterations)
    if again is None or again.score >= fitted.score + np.log(study.budget.left_in_finer_steps):
        return fitted
    return again
