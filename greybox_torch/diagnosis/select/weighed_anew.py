"""What was found is looked at once more with the outputs weighed by what it leaves of each, where that hides much of one.

Outputs are weighed by the errors of the model as it stands. Where what it lacks moved an exact sensor far, that sensor weighs little ever
after: with the law that was missing, all outputs together leave noise, and of this one's own far more is left. Weighed by what is left,
it shows what else is missing. That is taken only where nothing but noise is left with it; else all stays as it was.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.noise import over_experiments
from greybox_torch.diagnosis.select.offered import offer_all
from greybox_torch.diagnosis.select.plain_model import fit_plain_model, squared_errors, weights_by
from greybox_torch.diagnosis.select.remaining import completes
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.diagnosis.study import Study


def weighed_anew(study: Study, state: SearchState) -> tuple[Study, SearchState, str] | None:
    """The study with other weights, what completes the model then beside all that was found, and a sentence on that for the reader of a
    verdict; None where nothing is hidden, or nothing completes it.

    Seen: an axis whose encoder is 3 ms late, 150 times its noise (0.9 mm), beside a carriage's dry friction: told as friction alone.
    """
    if not state.effects or state.has_curve or len(study.problem.weights) < 2:
        return None
    left = squared_errors(state.current)
    times = np.sqrt(left / over_experiments(study.problem, study.settings))
    worst = int(np.argmax(np.nan_to_num(times)))
    if not completes(state.current, study.settings) or not times[worst] > study.settings.far_above_disturbances:
        return None
    study.working_on("weighing the outputs by what was found leaves of each")
    anew = replace(study, problem=replace(study.problem, weights=weights_by(study, left)))
    anew, begun = fit_plain_model(anew)
    offer_all(anew, begun)
    found = result_of(search(anew, replace(begun, found_before=state.current)))  # no score with other weights compares
    more = state.prefixes < found.prefixes and completes(found.current, study.settings)
    if not more:
        return None
    why = (
        f"What was found first left hardly more than noise in all outputs together, and {digits(float(times[worst]))} times its own in "
        f"{study.problem.model.outputs[worst].name}: the search was made once more with outputs weighed by what was left of each."
    )
    return anew, found, why
