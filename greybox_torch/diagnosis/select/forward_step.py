"""One forward step of the search: screen, refit the shortlist, compare, take the best candidate if it pays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial

from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.progress import Named
from greybox_torch.diagnosis.refit.likelihood import cost_of, likelier
from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, doubtful, in_order
from greybox_torch.diagnosis.refit.ties import rank_by_likelihood
from greybox_torch.diagnosis.screen.shortlist import Candidate, at_other_ports, shortlist, with_card, with_motion
from greybox_torch.diagnosis.select.bent_model import unbent_first
from greybox_torch.diagnosis.select.choice import as_unsure_as_a_name, chosen, least_gain, part_of_a_curve
from greybox_torch.diagnosis.select.compare import Comparison, compare
from greybox_torch.diagnosis.select.finer_curve import with_finer_curve, with_tied_curves_finer
from greybox_torch.diagnosis.select.found_before import with_found_before
from greybox_torch.diagnosis.select.its_best_values import tellable, with_values_that_say_something
from greybox_torch.diagnosis.select.offered import Screened, from_card, from_motion, screen_scores
from greybox_torch.diagnosis.select.posterior import believed
from greybox_torch.diagnosis.select.remaining import completes, leaves_little, left_to_complete
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study

MOST_POINTED_AT = 3
"""Of what a screen puts first, how many are kept for an answer without any refit."""


def forward_step(
    study: Study,
    state: SearchState,
    *,
    curves: bool = True,
    fine: bool = False,
    known: Sequence[RankedCandidate] = (),
    again: bool = True,
) -> Stage[SearchState]:
    """Screen, refit the shortlist, take the best if it pays; the state's last step says whether one was taken.

    Args:
        curves: offer free curves, where there is none yet: one says that something is unknown, and where; a second one would only fit
            what is left.
        fine: offer curves with many knots, and nothing else.
        known: refits on top of the state's hypothesis that were made before.
        again: repeat the step, once, from a far better fit of the state's hypothesis where refits have led to one.
    """
    screened = screen_scores(study, state, curves=curves and not state.has_curve, fine=fine)
    found = _worth_a_refit(study, state, screened, fine)
    _point_at(study, state, found)
    if not fine:
        at_card = from_card(study, state, curves=curves and study.bent)
        found = with_card(found, at_card) if study.bent else with_motion(found, at_card)
        found = with_motion(found, from_motion(study, state))
        found = with_found_before(study, state, found, curves=curves)
    if little_is_left(study, state):
        found = _that_may_complete(study, state, found)
    _point_at(study, state, found)
    ranked = rank(study, state.current, found)
    further = rank(study, state.current, _at_other_ports(study, state, screened, found, ranked))
    compared = compare(study, state.current, screened, in_order([*known, *ranked, *further], study.settings))
    if again and _in_another_valley(study, state, compared):
        there = with_better_fit(state, compared.parent)
        return (yield from forward_step(study, there, curves=curves, fine=fine, known=known, again=False))
    return (yield from _take(study, state, screened, compared))


def _point_at(study: Study, state: SearchState, found: Sequence[Candidate]) -> None:
    """Note what the screen puts first beside no effect: where the search is stopped before a step has ended, it is all that is known."""
    shares: dict[Named, float] = {}
    for candidate in sorted(found, key=lambda candidate: -candidate.explained):
        shares.setdefault(candidate.attachment.named, candidate.explained)
    if shares and not state.effects:
        study.journal.pointed_at(*list(shares.items())[:MOST_POINTED_AT])


def take_best(
    study: Study, state: SearchState, screened: Screened, ranked: Sequence[RankedCandidate]
) -> Stage[SearchState]:
    """End a step: compare what was refitted, and take the best if it pays; a free curve is then drawn more finely."""
    compared = compare(study, state.current, screened, ranked)
    kept = with_values_that_say_something(study, compared.parent, compared.ranked, ranked)
    return (yield from _take(study, state, screened, replace(compared, ranked=kept)))


def _in_another_valley(study: Study, state: SearchState, compared: Comparison) -> bool:
    """Whether a free curve leads and the refits have shown a far better fit of the hypothesis so far: what was screened and tried around
    the worse one tells little of which law it is that lacks. Not where a search with fewer experiments came to that curve, and it leaves
    hardly more than noise here as well.
    """
    if compared.parent.score >= state.current.score - study.settings.curve_margin or not compared.ranked:
        return False
    best = compared.ranked[0]
    known = bool(best.candidate.found_before) and completes(best.fitted, study.settings)
    return best.unknown and not known


def _take(study: Study, state: SearchState, screened: Screened, compared: Comparison) -> Stage[SearchState]:
    """Take the best of the compared candidates if it pays."""
    settings = study.settings
    state = with_better_fit(state, compared.parent)
    ranked = with_tied_curves_finer(study, compared.parent, compared.ranked)
    in_turn = rank_by_likelihood(tellable(study, ranked), settings, study.budget)
    cost_before = cache(partial(cost_of, compared.parent))
    paying = [r for r in in_turn if r.gain > least_gain(r.fitted, settings) and _sure(cost_before, r, settings)]
    paying = [r for r in paying if not _may_be_noise(study, state, r)]
    if little_is_left(study, state):
        paying = [r for r in paying if completes(r.fitted, settings)]
    if state.has_curve:
        paying = [r for r in paying if completes(r.fitted, settings) or _more_than_a_curve_lacks(state, r, settings)]
    paying = unbent_first(paying, settings)
    offered = [r for r in paying if not r.unknown or substantial(study, state, r)]
    led = chosen(offered, state.plain, settings, compared.parent)
    if led is not None and part_of_a_curve(led, paying, settings):
        led = None
    if led is not None and as_unsure_as_a_name(led, state.current, in_turn, settings):
        led = None
    taken = None if led is None else believed(led, paying, settings, study.beliefs)
    step = SelectionStep(screened, state.current, tuple(in_turn), taken, None if taken is led else led)
    state = replace(state.at(state.current if taken is None else taken.fitted), steps=(*state.steps, step))
    yield state
    return (yield from with_finer_curve(study, state)) if taken is not None and taken.unknown else state


def _sure(cost_before: Callable[[], float], ranked: RankedCandidate, settings: DiagnosisSettings) -> bool:
    """Whether a candidate improves on its parent beyond chance: over windows or, at the noise, by the likelihood of whole records.

    A law that removes most of the error is taken where windows leave that open, too: held-out experiments then decide. Seen: the weight
    of an arm that a propeller lifts, 89 % of the error, 2.4 standard errors, as the arm was at rest in most windows.
    """
    over_windows = ranked.significance > settings.least_significance or doubtful(ranked, settings)
    return over_windows or likelier(cost_before, ranked, settings)


def little_is_left(study: Study, state: SearchState) -> bool:
    """Whether what the effects so far leave of the mismatch is less than a finding is."""
    return bool(state.effects) and leaves_little(study, state.plain, state.current)


def with_better_fit(state: SearchState, fitted: Hypothesis) -> SearchState:
    """The state with a better fit of its hypothesis, which is the plain model's as well where there are no effects yet."""
    if fitted is state.current:
        return state
    return replace(state.at(fitted), plain=state.plain if fitted.effects else fitted)


def substantial(study: Study, state: SearchState, curve: RankedCandidate) -> bool:
    """Whether a free curve explains a part of the whole mismatch that counts, and not what a named law lacks to be the machine's.

    By less than the margin it would give way to names, or to nothing where no name pays. Of what hardly exceeds the noise it has to
    explain most. Seen: a complete aeration basin, of whose small disturbances a curve drew a quarter, told as unknown there (0.97).
    """
    least = _least_curve_share(state, study.settings)
    if not far_above_noise(state.plain, study.settings):
        least = study.settings.least_share_near_noise
    return curve.gain > study.settings.curve_margin and _removes(state, curve, least)


def _may_be_noise(study: Study, state: SearchState, taken: RankedCandidate) -> bool:
    """Whether an effect removes a small part of an error of which nobody knows how much is noise.

    Seen: a complete preheater, of whose error a constant removed a tenth (0.45, its look-alikes with it 0.97).
    """
    settings = study.settings
    if far_above_noise(state.plain, settings) or floor_known(state.plain.problem, settings):
        return False
    return not (state.effects or _removes(state, taken, settings.least_law_share_near_noise))


def _removes(state: SearchState, taken: RankedCandidate, least: float) -> bool:
    """Whether an effect removes more than a share of the plain model's squared error at some window length."""
    fits = zip(state.plain.fits, state.current.fits, taken.fitted.fits, strict=True)
    return any(b.mean_square - a.mean_square > least * p.mean_square for p, b, a in fits)


def _more_than_a_curve_lacks(state: SearchState, beside: RankedCandidate, settings: DiagnosisSettings) -> bool:
    """Whether an effect beside a free curve removes most of what that leaves.

    Seen: a brake whose friction depends on the disc's temperature, a curve beside which a loss of heat above 187 degC was told (0.85).
    """
    share = size(state.current.fits, state.current.fits, beside.fitted.fits, settings)
    return share >= settings.least_share_beside_curve


def _least_curve_share(state: SearchState, settings: DiagnosisSettings) -> float:
    """The part of the plain model's error that a free curve has to remove: more beside named effects, which are never exact."""
    return settings.least_curve_share_beside_names if state.effects else settings.least_curve_share


def _worth_a_refit(study: Study, state: SearchState, screened: Screened, fine: bool) -> list[Candidate]:
    """The shortlist, without what promises too little for the time that its refits take."""
    least, settings = 0.0, study.settings
    if fine and state.effects:
        least = settings.least_screen_share_of_fine_curve
    elif state.has_curve:
        least = settings.least_screen_share_beside_curve
    found = shortlist(study, screened, state.current.fits)
    return [k for k in found if k.explained >= least and (not k.unknown or _promising(study, state, k))]


def _that_may_complete(study: Study, state: SearchState, found: Sequence[Candidate]) -> list[Candidate]:
    """Those of which the screen leaves hope that nothing but noise is left with them, where nothing less is taken."""
    least = study.settings.completing_promise * left_to_complete(state.current, study.settings)
    return [k for k in found if k.found_before or k.explained >= least]


def _promising(study: Study, state: SearchState, curve: Candidate) -> bool:
    """Whether the screen leaves hope that a free curve is substantial: its refits are the slowest of all."""
    left = (c.mean_square / p.mean_square for p, c in zip(state.plain.fits, state.current.fits, strict=True))
    return curve.explained * max(left) > study.settings.curve_promise * _least_curve_share(state, study.settings)


def _at_other_ports(
    study: Study,
    state: SearchState,
    screened: Screened,
    found: Sequence[Candidate],
    ranked: Sequence[RankedCandidate],
) -> list[Candidate]:
    """The best named law at the ports where the screen did not put it among the first, if it pays."""
    best = next((r for r in ranked if not r.unknown), None)
    if best is None or best.gain < least_gain(best.fitted, study.settings):
        return []
    if best.significance < study.settings.least_significance and not doubtful(best, study.settings):
        return []
    known = [k.attachment for k in found]
    return at_other_ports(study, best.candidate.attachment, known, screened, state.current.fits)
