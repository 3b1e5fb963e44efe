"""A law in a form with fewer parameters, once others stand beside it.

Where an effect is still missing, the difference between the two directions of a law takes up a part of it. Seen: a dead zone with an offset
of the torque behind it, found as a zone that lies nearly on one side (0.84) with a third of the offset, as the two make up for one another;
a drum's ripple of four periods a turn, taken before its friction was, as two periods with five harmonics of which one was any.
"""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.refit.curve import values_without
from greybox_torch.diagnosis.refit.ranked import judged_beside
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.comes_as_far import comes_as_far
from greybox_torch.diagnosis.select.flexed import widened
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def with_plainer_forms(study: Study, state: SearchState) -> SearchState:
    """The state with each of its laws in a plainer form, where that comes as far beside the others."""
    for effect in state.effects if len(state.effects) > 1 else ():
        plainer = effect.mechanism.plainer(effect.own(state.current.values()))
        if plainer is not None:
            law = replace(effect, mechanism=plainer[0])
            begun = {f"{law.prefix}.{n}": v for n, v in plainer[1].items()}
            state = _in_form(study, state, effect, law, begun)
    return state


def _in_form(
    study: Study, state: SearchState, effect: Attachment, law: Attachment, begun: dict[str, float]
) -> SearchState:
    """The state with ``law``, which begins with the values ``begun``, in the place of ``effect``; as it is where that is not as good."""
    done = state.step_of(effect.prefix)
    if done is None or done.taken is None:
        return state
    study.working_on(f"refitting {effect.prefix} in a plainer form")
    start = values_without(state.current, effect) | begun
    found = fit(study, state.with_law(effect, law), [start], state.current.fits[0])
    if found is None or not comes_as_far(study, found, state.current):
        return state
    candidate = replace(done.taken.candidate, attachment=law)
    form = judged_beside(candidate, done.parent, state.plain, found, study.settings)
    return widened(state, done, form, found)
