"""The effects that a search with fewer experiments came to, estimated from one more, in the place of another search."""

from __future__ import annotations

from greybox_torch.diagnosis.refit.curve import over_its_range
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.select.remaining import remaining_share
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def with_same_effects(study: Study, begun: SearchState, before: SearchState) -> SearchState:
    """``begun`` with the effects of ``before``, and the steps that chose them; as it is where they leave as much as a finding is.

    An experiment that no free run follows is taken to choose with since it cannot score; what is there, the others have shown.
    """
    study.working_on("estimating what was found from one more experiment")
    effects, values = before.effects, before.current.values()
    curve = next((e for e in effects if e.mechanism.free), None)
    if curve is not None:
        drawn, values = over_its_range(before.current, curve, study.surroundings)
        effects = before.with_law(curve, drawn)
    fitted = refitted(study, effects, begun.current, [values])
    if fitted is None or remaining_share(begun.plain, fitted, study.settings) >= study.settings.least_size:
        return begun
    return SearchState(begun.plain, fitted, before.steps)
