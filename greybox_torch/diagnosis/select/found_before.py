"""What a search with fewer experiments came to, offered to the search with one more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greybox_torch.diagnosis.refit.curve import over_its_range
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown


def with_found_before(study: Study, state: SearchState, found: Sequence[Candidate], *, curves: bool) -> list[Candidate]:
    """Candidates, those that were taken before with the values that they had then, and those that the screen passes over as well.

    A curve that was found before is offered with all its knots, over the range that the signal has now.

    Args:
        curves: whether free curves and responses are offered.
    """
    known = _known(study, state, curves)
    named = {identity_of(c.attachment) for c in found}
    joined = [_joined(c, known.get(identity_of(c.attachment))) for c in found]
    return [*joined, *(c for identity, c in known.items() if identity not in named)]


def _known(study: Study, state: SearchState, curves: bool) -> dict[tuple, Candidate]:
    """The effects found before that are not in the hypothesis so far, as candidates."""
    before, offered = state.found_before, []
    if before is None:
        return {}
    for effect in before.effects:
        if effect.prefix in state.prefixes or (effect.mechanism.free and (state.has_curve or not curves)):
            continue
        if not available(study, effect):
            continue
        attachment, values = over_its_range(before, effect, study.surroundings)
        offered.append(Candidate(attachment, (), 0.0, found_before=(values,)))
    return {identity_of(c.attachment): c for c in offered}


def available(study: Study, effect: Attachment) -> bool:
    """Whether the experiments of a study have the signals of an effect that others led to: what drives and brakes a body depends on which
    way it turns there.
    """
    return effect.mechanism.available(study.surroundings[effect.port])


def _joined(candidate: Candidate, known: Candidate | None) -> Candidate:
    """A candidate that was found before: with those values first, and as the curve that it was."""
    if known is None:
        return candidate
    if isinstance(known.attachment.mechanism, Unknown):
        return replace(known, explained=candidate.explained, steps=candidate.steps)
    return replace(candidate, found_before=known.found_before)
