"""Every effect is tried without; what the rest make up for is dropped."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.degenerate import degenerate
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.curve import absorbed
from greybox_torch.diagnosis.refit.order import where_it_stood
from greybox_torch.diagnosis.refit.refitted import fit, refitted
from greybox_torch.diagnosis.select.choice import priced_score
from greybox_torch.diagnosis.select.comes_as_far import comes_as_far
from greybox_torch.diagnosis.select.plainer import with_plainer_forms
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.simulation.side_by_side import side_by_side


def drop_superfluous(study: Study, state: SearchState) -> Stage[SearchState]:
    """Drop every effect whose loss the rest make up for, until none can go; the state then knows what each was compared with.

    A form of a law that the rest make up for goes first; of several effects that could go, the one that is missed least. Seen: a heated
    block's leak, which went first as it had been found first, for a flow above a threshold that no sample lies below.
    """
    state = with_plainer_forms(study, state)
    while True:
        refits = side_by_side(partial(_without, study, state, e) for e in state.effects)
        without = dict(zip((e.prefix for e in state.effects), refits, strict=True))
        made_up_for = (h for h in refits if _made_up_for(study, state, h))
        superfluous = min(made_up_for, key=partial(priced_score, settings=study.settings), default=None)
        if superfluous is None:
            state = replace(state, without=without)
            yield state
            return state
        gone = next(e for e in state.effects if e not in superfluous.effects)
        state = replace(state.at(superfluous), made_up_for=(*state.made_up_for, (gone, state.current)))
        yield state


def drop(study: Study, state: SearchState, prefix: str) -> Stage[SearchState]:
    """Take one effect back, and what is superfluous without it; what it had made up for is asked again."""
    others = tuple(pair for pair in state.made_up_for if pair[0].prefix != prefix)
    state = replace(state.at(state.without[prefix]), made_up_for=others)
    yield state
    return (yield from drop_superfluous(study, _with_what_was_made_up_for(study, state)))


def _with_what_was_made_up_for(study: Study, state: SearchState) -> SearchState:
    """The state with the effects that others had made up for, which no longer do; the last that went is asked first."""
    asked, state = state.made_up_for, replace(state, made_up_for=())
    for effect, once in reversed(asked):
        if effect.prefix in state.prefixes:
            continue  # it came back by another way, or in another form
        study.working_on(f"trying {effect.prefix} again")
        found = refitted(study, where_it_stood(state.effects, effect, once.effects), state.current, [once.values()])
        if found is None or comes_as_far(study, state.current, found) or _says_nothing(study, effect, found):
            state = replace(state, made_up_for=((effect, once), *state.made_up_for))
        else:
            state = state.at(found)
    return state


def _says_nothing(study: Study, effect: Attachment, fitted: Hypothesis) -> bool:
    """Whether an effect's parameters describe nothing on the machine."""
    return degenerate(effect, study.surroundings, fitted.values(), {}) is not None


def _made_up_for(study: Study, state: SearchState, without: Hypothesis) -> bool:
    """Whether the other effects do as well alone."""
    return len(state.effects) > 1 and comes_as_far(study, without, state.current)


def _without(study: Study, state: SearchState, effect: Attachment) -> Hypothesis:
    """The hypothesis so far refitted without one of its effects."""
    rest = tuple(e for e in state.effects if e is not effect)
    if not rest:
        return state.plain
    done = state.step_of(effect.prefix)
    if (
        done is not None
        and done.taken is not None
        and done.taken.fitted is state.current
        and done.parent.effects == rest
    ):
        return _as_it_stands(study, state, rest, done.parent)
    study.working_on(f"trying without {effect.prefix}")
    handed_over = absorbed(state.current, effect, study.surroundings)
    return refitted(study, rest, state.current, [] if handed_over is None else [handed_over]) or state.plain


def _as_it_stands(study: Study, state: SearchState, rest: tuple[Attachment, ...], parent: Hypothesis) -> Hypothesis:
    """``parent``, polished already from where the newest effect had led, or, where that is lower, the rest as it stands beside the effect.

    Seen: the play of a yaw drive's gear, stuck at two thirds of its gap; a gear's error of half a microradian beside it (0.97) was what led
    on, by start states that it alone had.
    """
    study.working_on("leaving out the newest effect")
    there = fit(study, rest, [state.current.values()], state.current.fits[0], limits=study.budget.trial_iterations)
    return there if there is not None and there.score < parent.score - study.settings.score_tie else parent
