"""Which effects the data ask for: one at a time while it pays, each tried without, doubtful ones chosen once more."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.refit.behind_curve import laws_behind_curve
from greybox_torch.diagnosis.refit.ranked import in_order, judged
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.choice import priced_score
from greybox_torch.diagnosis.select.explore import explore, nothing_is_left
from greybox_torch.diagnosis.select.forward import take_effects
from greybox_torch.diagnosis.select.forward_step import forward_step, take_best
from greybox_torch.diagnosis.select.memory import with_memory
from greybox_torch.diagnosis.select.only_parts import only_parts
from greybox_torch.diagnosis.select.posterior import separated
from greybox_torch.diagnosis.select.rivals_beside import rivalled_beside_others
from greybox_torch.diagnosis.select.same_effects import with_same_effects
from greybox_torch.diagnosis.select.sparser_curve import with_sparser_curve
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage, result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown


def search(study: Study, state: SearchState, before: SearchState | None = None) -> Stage[SearchState]:
    """Search until nothing pays any more. Every state that it yields can be answered with; see :mod:`greybox_torch.diagnosis.stopping`.

    Args:
        before: what a search with fewer experiments came to, if its effects are to be kept where they leave less than a finding.
    """
    if before is not None:
        same = with_same_effects(study, state, before)
        if same is not state:
            yield same
            return (yield from without_idle_bumps(study, (yield from drop_superfluous(study, same))))
    state = yield from explore(study, state)
    state = yield from drop_superfluous(study, state)
    for _ in range(study.budget.most_revisions):
        if only_parts(study, state):
            return state
        before = state
        state = yield from revise(study, before)
        if state.current is before.current:
            break
        state = yield from take_effects(study, state)
        state = yield from drop_superfluous(study, state)
        if _same_laws(before, state):
            break  # what was chosen once more, and what joined it, was led back to what there was: so it would be again
    else:
        state = yield from _with_names_for_curves(study, state)
    before = state
    state = yield from with_memory(study, before)
    if state.current is not before.current:
        state = yield from take_effects(study, state)
        state = yield from drop_superfluous(study, state)
    return (yield from without_idle_bumps(study, state))


def _same_laws(one: SearchState, other: SearchState) -> bool:
    """Whether two states have the same effects in the same order, by which the newest is not chosen once more."""
    return [identity_of(e) for e in one.effects] == [identity_of(e) for e in other.effects]


def without_idle_bumps(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with its curve without the bumps that the recordings do not ask for, and without what the rest then make up for."""
    sparser = yield from with_sparser_curve(study, state)
    return state if sparser.current is state.current else (yield from drop_superfluous(study, sparser))


def revise(study: Study, state: SearchState) -> Stage[SearchState]:
    """Choose doubtful effects but the newest once more, beside the others: an early choice was made while those were still missing.

    So is one that was chosen beside what has gone since, the newest too, where more than noise is left. Once one is replaced, the rest is
    left as it is; where none is, the hypothesis is the same as before.
    """
    price = partial(priced_score, settings=study.settings)
    newest = state.newest
    named = yield from _with_names_for_curves(study, state)
    if named is not state:
        return named
    for effect in state.effects:
        gone = beside_what_is_gone(state, effect)
        beside_others = gone and not effect.mechanism.free and not nothing_is_left(study, state)
        doubtful = effect.prefix != newest and (
            not beyond_doubt(study, state, effect)
            or lost_an_amplitude(study, state, effect)
            or rivalled_beside_others(study, state, effect)
        )
        if not (doubtful or beside_others):
            continue
        study.working_on(f"choosing {effect.prefix} once more")
        other = result_of(forward_step(study, state.at(state.without[effect.prefix])))
        pays = other.took_one and price(other.current) < price(state.current) + study.settings.least_gain
        if pays and effect.prefix not in other.prefixes:
            yield other
            return (yield from drop_superfluous(study, other))
        state = replace(state, plain=other.plain, steps=other.steps if pays else state.steps)
    return state


def _with_names_for_curves(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with a law in the place of a free curve that was chosen beside what has gone since; as it is where none draws it as well.

    Seen: a platform's gravity, told as a curve: it was found beside the gain of a sensor, in whose place the gain of the torque came last.
    """
    for effect in state.effects:
        if isinstance(effect.mechanism, Unknown) and beside_what_is_gone(state, effect):
            named = yield from _named_behind(study, state, effect)
            if named is not state:
                return named
    return state


def _named_behind(study: Study, state: SearchState, curve: Attachment) -> Stage[SearchState]:
    """The state with a law in the place of a free curve that draws it; as it is where none does as well.

    Seen: a knee's stop, told as a curve: three laws stood for parts of it until the curve came, and without them it was asked for no name.
    """
    study.working_on(f"asking for a law behind {curve.prefix}")
    parent = state.without[curve.prefix]
    drawn = judged(Candidate(curve, (), 0.0), parent, state.current, study.settings)
    laws = laws_behind_curve(study, parent, [drawn], frozenset())
    named = result_of(take_best(study, state.at(parent), (), in_order([drawn, *laws], study.settings)))
    if not named.took_one or curve.prefix in named.prefixes:
        return state
    yield named
    return (yield from drop_superfluous(study, named))


def beside_what_is_gone(state: SearchState, effect: Attachment) -> bool:
    """Whether a law was chosen beside others of which one is no longer there.

    Seen: a sensor's dead time, told as a lag (0.97), which did better beside a curve and a delay that both fell away.
    """
    done = state.step_of(effect.prefix)
    return done is not None and any(e.prefix not in state.prefixes for e in done.parent.effects)


def beyond_doubt(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether no rival came near an effect in the step that took it."""
    done = state.step_of(effect.prefix)
    if done is None or done.taken is None:
        return False
    return separated(done.taken, done.ranked, study.settings, study.beliefs, done.led)


def lost_an_amplitude(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether later effects have taken over what one of a law's amplitudes stood for: then the law may have been theirs in part."""
    done = state.step_of(effect.prefix)
    if done is None or done.taken is None or effect.mechanism.free:
        return False
    names = [f"{effect.prefix}.{a}" for a in effect.mechanism.amplitudes(study.surroundings[effect.port])]
    once, now = done.taken.fitted.values(), state.current.values()
    return any(abs(now[n]) < study.settings.lost_amplitude * abs(once[n]) for n in names if n in once and n in now)
