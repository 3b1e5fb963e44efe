"""Two laws in the place of a free curve of one signal, where neither comes near it alone.

Dry friction that is much larger in one direction is two laws, a level and a difference. Refitted with one of them, the model bends so far
to make up for the other that the second is not found beside it.
"""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.refit.curve import two_laws_on_curve
from greybox_torch.diagnosis.refit.rank import judged, sound
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def with_two_laws(study: Study, start: SearchState, with_curve: SearchState) -> SearchState | None:
    """``start`` with the two laws that draw the curve which the last step of ``with_curve`` took; None where there are none.

    The step is on record as if it had taken the first of them.
    """
    done = with_curve.steps[-1]
    if done.taken is None or len(with_curve.effects) >= study.budget.most_effects:
        return None
    curve = with_curve.current.effects[-1]
    found = two_laws_on_curve(study.problem.model, with_curve.current, curve, study.surroundings)
    if found is None or any(study.beliefs.exclude(law) for law in found[0]):
        return None
    laws, values = found
    study.working_on(f"refitting {laws[0].prefix} and {laws[1].prefix} from the curve")
    fitted = fit(study, (*start.effects, *laws), [values, {**values, **study.card}], with_curve.current.fits[0])
    if fitted is None:
        return None
    both = [
        judged(Candidate(law, (), done.taken.candidate.explained), start.current, fitted, study.settings)
        for law in laws
    ]
    if not all(sound(study, one) for one in both):
        return None
    step = replace(done, taken=both[0], led=None)
    return replace(start.at(fitted), steps=(*start.steps, step))
