"""The free curve that was just taken, drawn more finely."""

from __future__ import annotations

from greybox_torch.diagnosis.refit.curve import finer
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.unknown import Unknown


def with_finer_curve(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with its newest effect, a curve, drawn with twice the knots, and so on, as long as that pays and means anything."""
    while _may_be_finer(study, state):
        study.working_on("drawing the curve more finely")
        drawn = state.current
        attachment, values = finer(drawn, drawn.effects[-1], study.surroundings)
        effects = (*drawn.effects[:-1], attachment)
        fitted = fit(study, effects, [values], drawn.fits[0], limits=study.budget.window_iterations)
        if fitted is None or fitted.score > drawn.score - study.settings.least_gain:
            break
        state = state.at(fitted)
        yield state
        if fitted.score >= drawn.score - study.settings.curve_margin:
            break
    return state


def _may_be_finer(study: Study, state: SearchState) -> bool:
    curve = state.effects[-1].mechanism
    if not isinstance(curve, Unknown):
        return False  # a response with memory
    wanted = len(state.current.problem.free_names) + curve.knots
    return not curve.only_coarse and wanted < study.budget.most_parameters
