"""A law that was found, in a form with more parameters: a ripple with harmonics, a limit that differs by direction.

What a plain form leaves of its own law stands far above the noise of a good sensor, and some other law takes up a part of it. So before
the next step the form that has it is asked, which as one law is a simpler answer than two.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known, noise_floor
from greybox_torch.diagnosis.refit.possible_form import possible_form
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged, sound
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.as_two_laws import two_in_its_place
from greybox_torch.diagnosis.select.choice import alone_at_noise, least_gain, priced_score
from greybox_torch.diagnosis.select.flexed import widened
from greybox_torch.diagnosis.select.forms import forms, forms_of_both
from greybox_torch.diagnosis.select.remaining import completes, remaining_share
from greybox_torch.diagnosis.select.rivals_of_form import with_rivals_of_form
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def with_richer_form(study: Study, state: SearchState, done: SelectionStep | None = None) -> Stage[SearchState]:
    """The state with the law of a step in the richer form that goes farthest for its parameters, where that takes up most of what is left.

    Args:
        done: that step, by default the last one.
    """
    done = done or state.steps[-1]
    if done.taken is None or only_noise(study.problem, state.current, study.settings):
        return state
    taken = done.taken
    effect = taken.candidate.attachment
    single = ((law, start) for law, start in forms(effect, state, study.beliefs) if not law.mechanism.stands_for)
    tried = (_in_form(study, state, taken, law, start) for law, start in single)
    paying = [r for r in tried if r is not None and _preferred(study, state, effect, r)]
    best = min(paying, key=lambda r: priced_score(r.fitted, study.settings), default=None)
    if best is None:
        return state
    newest = done is state.steps[-1]
    state = widened(state, done, _beside_rivals(taken, best), best.fitted)
    yield state
    if newest:
        state = with_rivals_of_form(study, state)
        yield state
    return state


def with_earlier_law_richer(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with one of the laws that were found before the newest in a richer form, asked where no further effect pays.

    Beside all that was still missing when a law was found, a richer form takes up little. Seen: the bump stops of a vehicle, told as a
    curve beside the delay of a sensor, which left more than what the polynomial of its spring lacks.
    """
    for effect in state.effects[:-1]:
        done = state.step_of(effect.prefix)
        richer = state if done is None else (yield from with_richer_form(study, state, done))
        if richer is not state:
            return richer
    return state


def richer_instead(study: Study, before: SearchState, after: SearchState) -> SearchState | None:
    """``before`` with a law at the port of the newest effect in a richer form, where that does as well as ``after`` with one more effect.

    None where no such form does, where two laws do as well, or where ``after`` took nothing. A second harmonic is not seen beside
    all that a first one leaves while other effects are missing; once they are found, some other law of the same port takes it up.
    """
    newest = after.steps[-1].taken
    if newest is None:
        return None
    to_reach = priced_score(after.current, study.settings) + study.settings.score_tie
    latest = newest.candidate.attachment
    for effect in (e for e in before.effects if e.port == latest.port):
        done = before.step_of(effect.prefix)
        if done is None or done.taken is None:
            continue
        for law, start in forms_of_both(effect, latest, before, after, study.beliefs):
            found = _in_form(study, before, done.taken, law, start)
            far = (
                found is not None and priced_score(found.fitted, study.settings) <= to_reach and _improves(study, found)
            )
            if found is not None and far and two_in_its_place(study, found.fitted, law) is None:
                in_step = _beside_rivals(done.taken, found)
                return replace(widened(before, done, in_step, found.fitted), plain=after.plain)
    return None


def as_one_law(study: Study, state: SearchState) -> SearchState:
    """``state`` with the two laws of a port that one law stands for as that one, where it does as well; as it is elsewhere.

    Asked once a law of the two has become one that is stood for. Seen: the friction of a crane's slewing ring, 0.35 N m and 62 % of it once
    per turn, found as Stribeck friction and friction over the position; without its peak the former was Coulomb's.
    """
    for count in range(len(state.steps), 0, -1):
        taken = state.steps[count - 1].taken
        prefix = "" if taken is None else taken.candidate.attachment.prefix
        if prefix in state.without:
            before = replace(state.at(state.without[prefix]), steps=state.steps[: count - 1])
            one = richer_instead(study, before, replace(state, steps=state.steps[:count]))
            if one is not None:
                return one
    return state


def _beside_rivals(plain: RankedCandidate, form: RankedCandidate) -> RankedCandidate:
    """A form as its step has its rivals: with what it gains on the hypothesis that these build on, not on the plain form alone."""
    both = {n: getattr(plain, n) + getattr(form, n) for n in ("gain", "plausible")}
    return replace(form, **both, significance=max(plain.significance, form.significance))


def _improves(study: Study, found: RankedCandidate) -> bool:
    """Whether a form goes farther than the plain one, beyond chance, with parameters that say something of the machine."""
    settings = study.settings
    further = found.gain > least_gain(found.fitted, settings) and found.significance > settings.least_significance
    return further and sound(study, found)


def _in_form(
    study: Study, state: SearchState, taken: RankedCandidate, law: Attachment, start: Mapping[str, float]
) -> RankedCandidate | None:
    """The hypothesis of ``state`` with a form of the effect that was taken, compared with it; None where the port lacks what it needs."""
    if not possible_form(study, law):
        return None
    effect = taken.candidate.attachment
    study.working_on(f"refitting {effect.prefix} in a richer form")
    fitted: Hypothesis | None = fit(study, state.with_law(effect, law), [dict(start)], state.current.fits[0])
    candidate = replace(taken.candidate, attachment=law)
    return None if fitted is None else judged(candidate, state.current, fitted, study.settings)


def _preferred(study: Study, state: SearchState, effect: Attachment, ranked: RankedCandidate) -> bool:
    """Whether a form takes the place of the effect. One under another name is a rival of it, which has to leave less than half.

    Where the time is hardly resolved, a lag of second order and a dead time differ by what each lacks to be the machine's, and what is
    beyond the noise counts only where the recordings tell how much noise there is. Where the effect leaves less of the mismatch than a
    finding is, its rival has to leave noise alone. Seen: a truck's dead time of 70 ms, told as a lag of second order for 0.4 % of it.
    """
    before, settings = state.current, study.settings
    if ranked.candidate.attachment.named == effect.named:
        return _pays(study, state, ranked)
    if remaining_share(state.plain, before, settings) < settings.least_size and not completes(ranked.fitted, settings):
        return False
    half = settings.most_of_the_mismatch
    known = floor_known(before.problem, settings)
    far = _takes_up(study, before, ranked, half) if known else _removes(ranked, half)
    return far and _improves(study, ranked)


def _pays(study: Study, state: SearchState, ranked: RankedCandidate) -> bool:
    """Whether a form takes up most of what the plain one leaves, beyond chance: less may be another effect's.

    Or leaves white noise alone where the plain one does not, as a free curve has to that stands before a name. Seen: a drive's dead band
    with round corners, told as a curve over its input; with sharp ones hardly more than noise was left, of which forms take up no part.
    """
    before, settings = state.current, study.settings
    most = _takes_up(study, before, ranked, settings.least_of_richer_form)
    enough = most or alone_at_noise(ranked.fitted, before, state.plain, settings)
    return enough and ranked.significance > settings.least_significance and sound(study, ranked)


def _takes_up(study: Study, before: Hypothesis, ranked: RankedCandidate, share: float) -> bool:
    """Whether a form removes such a share of what the plain one leaves.

    Of the squared error over all window lengths, or of what is beyond the noise over those that show it best: over short windows the plain
    form may leave noise alone.
    """
    return _removes(ranked, share) or _left_where_it_shows(before, ranked.fitted, study.settings) < 1 - share


def _removes(ranked: RankedCandidate, share: float) -> bool:
    """Whether a form removes such a share of the squared error over all window lengths."""
    return ranked.gain > -float(np.log1p(-share))


def _left_where_it_shows(before: Hypothesis, after: Hypothesis, settings: DiagnosisSettings) -> float:
    """The share of the squared error beyond the noise that a form leaves, over the windows in which the plain one leaves most of it.

    All of it where the plain one leaves hardly more than noise.
    """
    if completes(before, settings):
        return 1.0
    plain, form = max(zip(before.fits, after.fits, strict=True), key=lambda pair: pair[0].mean_square)
    floor = noise_floor(plain.problem, settings)
    return max(form.mean_square - floor, 0.0) / (plain.mean_square - floor)
