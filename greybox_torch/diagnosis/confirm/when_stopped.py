"""What stands of a search that was stopped before free runs had judged what it found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from greybox_torch.diagnosis.confirm.curve_instead import curves_of
from greybox_torch.diagnosis.confirm.holding import Judged
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.hypothesis.final import from_longest_windows
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def found_first(study: Study, state: SearchState, judged: Judgement) -> Judged:
    """The effect of the first step, or those of the first two, or the first step's curve, with the values of their windows: what of these
    free runs leave at most half with.

    Each of them costs a comparison with all experiments, hence no more than these. Seen: an arm's mode, told as a gain (the statement says
    both), whose search found the gear's errors beside it, none of which lasted: all was taken back when time was over, and 300 times the
    noise left without a name. An arm's friction over its position and its spring's play, of which neither is half of the mismatch. A notch
    of a gear, whose curve came second, behind a transmission error that removes a twelfth.
    """
    for stands in (*_names(study, state), *_curve(study, state)):
        alone = judged.having(from_longest_windows(stands.current))
        if alone.holds and alone.mismatch(True) <= study.settings.left_if_far_better * alone.mismatch(False):
            return stands, {}, alone, (), False
    return state.at(state.plain), {}, judged.without_effects(), (), False


def _names(study: Study, state: SearchState) -> Iterator[SearchState]:
    """The state with what the first step took, and with what the first two took, while these are sound names."""
    for found in _first_found(state):
        if not all(not taken.unknown and sound(study, taken) for taken in found):
            return
        yield state.at(found[-1].fitted)


def _curve(study: Study, state: SearchState) -> Iterator[SearchState]:
    """The state with the curve or response that the first step took, or that went farthest there, if by more than the margin of curves."""
    step = next(iter(state.steps), None)
    if step is None or step.parent.effects:
        return
    taken = step.taken is not None and step.taken.unknown
    curve = step.taken if taken else next(iter(curves_of(study, step)), None)
    if curve is not None and curve.gain > study.settings.curve_margin:
        beside = () if taken else (replace(step, taken=curve),)
        yield replace(state.at(curve.fitted), steps=(*state.steps, *beside))


def _first_found(state: SearchState) -> list[tuple[RankedCandidate, ...]]:
    """What the first step took, and what the first two took, the second built upon the first."""
    begun: list[tuple[RankedCandidate, ...]] = []
    for step in state.steps:
        before = begun[-1] if begun else ()
        built_upon = {taken.candidate.attachment.prefix for taken in before}
        if step.taken is not None and {e.prefix for e in step.parent.effects} == built_upon and len(begun) < 2:
            begun.append((*before, step.taken))
    return begun
