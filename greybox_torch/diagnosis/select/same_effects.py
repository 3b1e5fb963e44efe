"""The effects that a search with fewer experiments came to, estimated from one more, in the place of another search."""

from __future__ import annotations

from greybox_torch.diagnosis.refit.curve import redrawn
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.remaining import remaining_share
from greybox_torch.diagnosis.select.sparser_curve import with_sparser_curve
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown


def with_same_effects(study: Study, begun: SearchState, before: SearchState) -> Stage[SearchState]:
    """``begun`` with the effects of ``before``, and the steps that chose them; as it is where they leave as much as a finding is.

    An experiment that no free run follows is taken to choose with since it cannot score; what is there, the others have shown.
    """
    study.working_on("estimating what was found from one more experiment")
    effects, values = _over_the_ranges(study, before)
    fitted = refitted(study, effects, begun.current, [values])
    if fitted is None or remaining_share(begun.plain, fitted, study.settings) >= study.settings.least_size:
        return begun
    state = SearchState(begun.plain, fitted, before.steps)
    yield state
    state = yield from drop_superfluous(study, state)
    sparser = yield from with_sparser_curve(study, state)
    return state if sparser.current is state.current else (yield from drop_superfluous(study, sparser))


def _over_the_ranges(study: Study, before: SearchState) -> tuple[tuple[Attachment, ...], dict[str, float]]:
    """The effects, a curve with all its knots over the range that its signal has now, and their values."""
    effects, values = before.effects, before.current.values()
    for effect in effects:
        if isinstance(effect.mechanism, Unknown):
            around = study.surroundings[effect.port]
            drawn, values = redrawn(before.current, effect, around, effect.mechanism.knots)
            return before.with_law(effect, drawn), values
    return effects, values
