"""Laws that the found ones contain, refitted in their place."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain, pooled
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import likelihood_significance, window_significance
from greybox_torch.diagnosis.refit.curve import values_without
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged_beside
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.shortlist import contains
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.select.finer_steps import finely_enough
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.simulation.side_by_side import side_by_side


def with_simpler_laws(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """Take the law that an effect's law contains instead, where the larger one predicts other experiments no better."""
    for effect in state.effects:
        if effect.prefix not in state.prefixes:
            continue  # pruned beside a simpler law
        for rival, simpler in _contained(study, state, effect):
            before, after = side_by_side(partial(others.fits, h) for h in (simpler, state.current))
            if _by_chance(study, simpler, state.current, gain(before, after)):
                state = _with_rival(state, rival, simpler, effect)
                yield state
                state = yield from drop_superfluous(study, state)
                break
    return state


def _by_chance(study: Study, simpler: Hypothesis, larger: Hypothesis, held_out: Gain) -> bool:
    """Whether a law's advantage over one that it contains may be chance.

    The likelihood of white noise counts every sample, and a slow disturbance that is in them all over and over. It stands alone only where
    the windows of all experiments together, within which errors are correlated as they are, say the same. Seen: constant forces of three
    plants told as friction that differs by direction (0.92 to 0.97), 3 to 10 standard errors by that likelihood, one by windows.
    """
    settings = study.settings
    if held_out.errors_away >= settings.held_out_beyond_chance:
        return False
    if likelihood_significance(simpler, larger, settings) < settings.least_significance:
        return True
    chosen_by = gain(simpler.fits, larger.fits)
    return pooled([chosen_by, held_out]).errors_away < settings.held_out_beyond_chance


def simplified(study: Study, state: SearchState, effect: Attachment) -> SearchState | None:
    """The state with the best of the laws that the law of ``effect`` contains in its place, refitted from what the two have in common.

    None where it contains none, or none that is not there already can be simulated.
    """
    done = state.step_of(effect.prefix)
    if done is None or done.taken is None:
        return None
    found, beside = [], {e.prefix for e in state.effects if e is not effect}
    others = values_without(state.current, effect)
    for name in (n for n in effect.mechanism.generalises if n in LIBRARY):
        law = attach(study.problem.model, effect.port, LIBRARY[name](), effect.shifted_state)
        if law.prefix in beside or study.beliefs.exclude(law):
            continue
        begun = effect.mechanism.contained_as(effect.own(state.current.values()))
        starts = [others | {f"{law.prefix}.{n}": v for n, v in own.items()} for own in begun]
        fitted = refitted(study, state.with_law(effect, law), state.current, starts)
        if fitted is not None:
            candidate = replace(done.taken.candidate, attachment=law)
            found.append(judged_beside(candidate, done.parent, state.plain, fitted, study.settings))
    best = min(found, key=lambda r: r.fitted.score, default=None)
    return None if best is None else _with_rival(state, best, best.fitted, effect)


def _contained(study: Study, state: SearchState, effect: Attachment) -> list[tuple[RankedCandidate, Hypothesis]]:
    """Laws that the law of ``effect`` contains, of those that were refitted beside it, and each in its place beside the others.

    In as fine steps as it needs. Seen: a press's dry friction, whose sign changes within 0.3 mm/s, told as presliding of 18 um (0.97); the
    lower stop of a dancer roll, told as stops at both ends, whose upper one stopped the roll in the held-out experiments.
    """
    done, found = state.step_of(effect.prefix), []
    beside = {e.prefix for e in state.effects if e is not effect}
    for rival in done.ranked if done is not None else ():
        other = rival.candidate.attachment
        if contains(effect, other) and other.prefix not in beside:
            study.working_on(f"refitting {other.prefix} in the place of {effect.prefix}")
            fitted = refitted(study, state.with_law(effect, other), state.current, [rival.fitted.values()])
            found += [] if fitted is None else [(rival, finely_enough(study, fitted, other))]
    at_the_end = None if done is None else _limit(study, state, effect, done)
    return found if at_the_end is None else [*found, at_the_end]


def _limit(
    study: Study, state: SearchState, effect: Attachment, done: SelectionStep
) -> tuple[RankedCandidate, Hypothesis] | None:
    """The law that the one of ``effect`` becomes at the end of a parameter's range, in its place; None where windows that chose tell them.

    Seen: a valve's stem that truly sticks, told as presliding of 18 um (0.97), the least that its law has; a block's loss of heat to the
    air, told as a flow above 29.8 degC (0.85), below which 3 % of the samples were: once told with a leak, and the leak dropped beside it.
    """
    ended = effect.mechanism.limit(effect.own(state.current.values()))
    if ended is None or done.taken is None:
        return None
    law = replace(effect, mechanism=ended[0])
    if law.prefix in state.prefixes or study.beliefs.exclude(law):
        return None
    study.working_on(f"refitting {law.prefix} in the place of {effect.prefix}")
    begun = {f"{law.prefix}.{n}": v for n, v in ended[1].items()}
    fitted = refitted(
        study, state.with_law(effect, law), state.current, [values_without(state.current, effect) | begun]
    )
    if fitted is None or not _alike(study, fitted, state.current):
        return None
    candidate = replace(done.taken.candidate, attachment=law)
    return judged_beside(candidate, done.parent, state.plain, fitted, study.settings), fitted


def _alike(study: Study, one: Hypothesis, other: Hypothesis) -> bool:
    """Whether two hypotheses fit the windows that chose alike, but for chance."""
    settings = study.settings
    ahead = one.score - other.score
    return (
        ahead < least_gain(other, settings) or window_significance(one, other, settings) < settings.least_significance
    )


def _with_rival(state: SearchState, rival: RankedCandidate, fitted: Hypothesis, effect: Attachment) -> SearchState:
    """The state with the law of ``rival`` in the place of ``effect``, as if the step had found that.

    What was found in a step of its own stands beside the rivals of that: those of the other step were judged with it there.
    """
    law = rival.candidate.attachment.prefix
    own = None if law == effect.prefix else state.step_of(law)
    if own is not None and all(e.prefix != effect.prefix for e in own.parent.effects):
        return state.at(fitted)
    done = state.step_of(effect.prefix)
    steps = tuple(replace(s, taken=rival) if s is done else s for s in state.steps)
    return replace(state.at(fitted), steps=steps)
