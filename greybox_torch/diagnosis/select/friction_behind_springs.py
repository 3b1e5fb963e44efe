"""Dry friction of a light body behind a spring, asked where it was told as friction of the body in front.

A spring that ends at a body held by dry friction does what bristles do at the body in front: it bends, then that body slips. So bristles
there come far while the spring itself goes soft or the body behind it rings, which no machine does; from such values no refit leads back.
And dry friction that holds a light body is stiff: in steps of a sample no refit moves. Here it is asked in finer steps, from the values
of the card too, within a range of speeds as what was found has them. Seen: the packing of a valve's plug, told as bristles at its
actuator (0.85), with 27 times the noise left; a wiper's blade, told as bristles at its motor (0.85), with an arm 300 times too soft.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.possible_form import possible_form
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged, sound
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.at_joined_bodies import converged, elsewhere
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.bent_model import narrowed
from greybox_torch.diagnosis.select.choice import chosen, priced_score
from greybox_torch.diagnosis.select.forward import take_effects
from greybox_torch.diagnosis.select.forward_step import little_is_left
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.select.wider_ranges import ranges_with
from greybox_torch.diagnosis.stopping import or_else, result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.stribeck import StribeckFriction

SELDOM = 0.02
"""Share of the samples at either end in which a speed says nothing of how fast a body moves: where windows begin, one that no sensor shows
may ring."""

LAWS = (CoulombFriction, StribeckFriction, PreslidingHysteresis)
"""What holds a body and lets it slip."""

FORMS = (CoulombFriction(), CoulombFriction(sticking=True), StribeckFriction(), PreslidingHysteresis())
"""Their forms that are asked for: where tanh is too stiff for any step, short bristles hold a body as well."""

LEVELS = (CoulombFriction.parameter, "F")
"""What their parameters call the level at which a body slips."""

Begun = tuple[Attachment, Mapping[str, float]]
"""A law and values of its own to begin with."""


def friction_behind_springs(study: Study, state: SearchState) -> tuple[Study, SearchState] | None:
    """The study with the ranges as the hypothesis of ``state`` has them, and dry friction behind a spring in the place of that which was
    told in front of it; None where nothing speaks for it, or where it goes no farther.
    """
    held = [e for e in state.effects if isinstance(e.mechanism, LAWS)]
    if not held or only_noise(study.problem, state.current, study.settings):
        return None
    slower, bent = _slower(study, state.current), _bent(study, state.current)
    if not slower and not bent:
        return None
    study = replace(study, surroundings={**study.surroundings, **slower})
    found = []
    for effect in held:
        laws = [law for law in _laws(study, state, effect) if bent or law[0].port in slower]
        found += [there for there in (_elsewhere(study, state, effect, laws),) if there is not None]
    price = partial(priced_score, settings=study.settings)
    best = min(found, key=lambda there: price(there.current), default=state)
    if price(best.current) > price(state.current) - study.settings.least_gain:
        return None
    if little_is_left(study, best):
        return study, best
    return study, or_else(partial(_with_more, study, best), lambda: best)[0]


def _with_more(study: Study, state: SearchState) -> SearchState:
    """``state`` with what else pays beside it."""
    return result_of(drop_superfluous(study, result_of(take_effects(study, state))))


def _slower(study: Study, fitted: Hypothesis) -> dict[str, Surroundings]:
    """The bodies that move much less with the effects of a hypothesis than in the model as it stands, with that range of their speed."""
    found, there = {}, narrowed(study.surroundings, ranges_with(study, fitted, SELDOM), study.settings.bent_travel)
    for port, around in study.surroundings.items():
        own, now = around.ranges.get("speed"), there[port].ranges.get("speed")
        if own is not None and now is not None and now != own:
            found[port] = replace(around, ranges={**around.ranges, "speed": now})
    return found


def _bent(study: Study, fitted: Hypothesis) -> bool:
    """Whether a parameter of the model itself is many times what the card has, or such a part of it."""
    values = fitted.values()
    ratios = (abs(values[n] / began) for n, began in study.card.items() if began and values.get(n))
    return any(abs(np.log(ratio)) > np.log(study.settings.bent_parameter) for ratio in ratios)


def _laws(study: Study, state: SearchState, effect: Attachment) -> Iterator[Begun]:
    """The laws that hold a body, at those that springs join with that of ``effect`` and at its own, in finer steps; none without."""
    own, finer = effect.own(state.current.values()), study.budget.substeps_of_dry_friction * study.options.substeps
    level = next((own[n] for n in LEVELS if n in own), 0.0)
    joined = list(elsewhere(study, effect))
    for law in joined:
        yield replace(law, substeps=finer), own
    for port in (effect.port, *(law.port for law in joined)) if joined else ():
        for form in (f for f in FORMS if not _same_form(f, effect.mechanism)):
            law = attach(study.problem.model, port, form)
            if possible_form(study, law) and not study.beliefs.exclude(law):
                yield replace(law, substeps=finer), dict.fromkeys(LEVELS, level)


def _same_form(one: Mechanism, other: Mechanism) -> bool:
    return type(one) is type(other) and vars(one) == vars(other)


def _elsewhere(study: Study, state: SearchState, effect: Attachment, laws: Sequence[Begun]) -> SearchState | None:
    """``state`` as if the step that took ``effect`` had taken the one of ``laws`` that goes farthest, without what was taken later or
    beside it, whichever goes farther; None where none can be fitted.
    """
    done = state.step_of(effect.prefix)
    if done is None:
        return None
    there = {e.prefix for e in (*done.parent.effects, *state.effects)} - {effect.prefix}
    asked = [law for law in laws if law[0].prefix not in there]
    ranked = in_order([r for law in asked if (r := _refitted(study, state, done, effect, law))], study.settings)
    taken = chosen([r for r in ranked if sound(study, r)], state.plain, study.settings)
    if taken is None:
        return None
    every = in_order([*ranked, *done.ranked], study.settings)
    best = {r.candidate.attachment.named: r for r in reversed(every)} | {taken.candidate.attachment.named: taken}
    step = replace(done, ranked=tuple(r for r in every if any(r is b for b in best.values())), taken=taken, led=None)
    steps = tuple(step if s is done else s for s in state.steps)
    beside = _beside_the_rest(study, state, effect, done, taken)
    least = priced_score(taken.fitted, study.settings) - study.settings.least_gain
    if beside is not None and priced_score(beside, study.settings) <= least:
        return replace(state.at(beside), steps=steps)
    last = next(i for i, s in enumerate(steps) if s is step)
    before = tuple(s for s in steps[: last + 1] if s.taken is not None)
    return replace(state.at(taken.fitted), steps=before, named=None, made_up_for=())


def _beside_the_rest(
    study: Study, state: SearchState, effect: Attachment, done: SelectionStep, taken: RankedCandidate
) -> Hypothesis | None:
    """The hypothesis of ``state`` with the law ``taken`` in the place of ``effect``; None where that was all, or cannot be fitted."""
    if state.prefixes - {effect.prefix} == {e.prefix for e in done.parent.effects}:
        return None
    effects = state.with_law(effect, taken.candidate.attachment)
    fitted = fit(study, effects, [{**state.current.values(), **taken.fitted.values()}], state.current.fits[0])
    return None if fitted is None else converged(study, fitted)


def _refitted(
    study: Study, state: SearchState, done: SelectionStep, effect: Attachment, law: Begun
) -> RankedCandidate | None:
    """What the step that took ``effect`` comes to with ``law``, from the values of ``state`` and from the card's; None where nowhere."""
    there, own = law
    study.working_on(f"refitting {there.prefix} in the place of {effect.prefix}")
    start = {**state.current.values(), **{f"{there.prefix}.{n}": v for n, v in own.items()}}
    fitted = fit(study, (*done.parent.effects, there), [start, {**start, **study.card}], state.current.fits[0])
    if fitted is None:
        return None
    return judged(Candidate(there, (), 0.0), done.parent, converged(study, fitted), study.settings)
