"""Laws that the search refitted and passed over, in the place of what stands, where free runs leave far less with them.

Windows have start states of their own, which take up what is slow, and few of them leave a second law open. A free curve follows the
motion that it was drawn on; between its knots, and where another record goes, it says little. The free runs of held-out experiments know
better. Seen: a pendulum that swings out, whose dry friction was told as a curve with knots every 1.9 rad/s (0.97, validation 82 %): dry
friction alone reaches 88 %, with drag 97 %.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.confirm.far_better import Standing, leaving_far_less
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.with_one_more import with_each_left_out
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.significance import over_the_same_windows
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study
from greybox_torch.name_lists import listed
from greybox_torch.simulation.side_by_side import side_by_side


def refitted_laws(study: Study, state: SearchState, others: HeldOut | None, judged: Judgement) -> Standing | None:
    """The laws of a step of the search with which free runs leave half of the mismatch of ``state`` or less, all of them borne out by
    held-out windows beyond chance; None where there are none, or where so little is left that it is not asked.

    Of those that leave about as little, the fewest with the fewest parameters. With several validation experiments only in the place of a
    free curve: for names, and for nothing, one of these is taken to choose with, and the others judge. Seen: an engine's pendulum, told as
    Stribeck friction for its free runs, 9 % left; once one experiment more chose, Coulomb friction left 0.9 %.
    """
    if others is None or (len(others.problem.records.first) > 1 and not state.has_curve):
        return None
    settings = study.settings
    share, times, _ = judged.left(bool(state.effects))
    least = settings.left_to_doubt_a_curve if state.has_curve else settings.least_size
    above = settings.far_above_noise if state.effects else settings.far_above_disturbances
    if not (share > least and times > above):
        return None

    def asked(step: SelectionStep, law: RankedCandidate) -> Standing | None:
        study.working_on(f"asking free runs about {' and '.join(e.prefix for e in law.fitted.effects)}")
        base = state.at(step.parent)
        steps = (*state.steps, replace(step, taken=law, led=None))
        other = replace(base.at(law.fitted), steps=steps, named=None, by_free_runs=not state.has_curve)
        compared = partial(with_each_left_out, study, base)
        return leaving_far_less(study, other, others, judged, lambda by_it: judged.mismatch(True), compared)

    answers = side_by_side(partial(asked, *one) for one in _asked(study, state))
    found = [standing for standing in answers if standing is not None]
    about = min((by_it.mismatch(True) for _, _, by_it in found), default=0.0) / settings.left_if_far_better
    near = [one for one in found if one[2].mismatch(True) <= about]
    return min(near, key=_simplest_first, default=None)


def chosen_by_free_runs(standing: Standing, before: SearchState, judged: Judgement) -> str:
    """What the reader of a verdict has to know of laws that took the place of those of ``before``, which ``judged`` has."""
    state, _, by_it = standing
    laws = listed([spoken_at(*e.named[::-1]) for e in state.effects])
    was, now = (digits(100.0 * j.mismatch(True) / max(j.mismatch(False), 1e-300)) for j in (judged, by_it))
    preferred = (
        f"and {was} % with what windows preferred" if before.effects else "and nothing that windows preferred lasted"
    )
    return (
        f"{laws}: told for the free runs of the validation experiments, which so had a part in choosing. They leave {now} % of the "
        f"mismatch so, {preferred}."
    )


def _simplest_first(standing: Standing) -> tuple[int, int, float]:
    state, _, by_it = standing
    return len(state.effects), int(state.current.problem.free.sum()), by_it.mismatch(True)


def _asked(study: Study, state: SearchState) -> Iterator[tuple[SelectionStep, RankedCandidate]]:
    """The refits of laws alone, at most one more than there are effects now, that gained about as much as the best of their step; of each
    number of laws those that fit best.
    """
    found: dict[frozenset[str], tuple[SelectionStep, RankedCandidate]] = {}
    for step in state.steps:
        if any(e.mechanism.free for e in step.parent.effects) or not over_the_same_windows(step.parent, state.plain):
            continue
        for law in _near(study, step):
            laws = frozenset(e.prefix for e in law.fitted.effects)
            known = found.get(laws)
            if known is None or law.fitted.score < known[1].fitted.score:
                found[laws] = step, law
    found.pop(frozenset(state.prefixes), None)
    in_turn = sorted(found.values(), key=lambda pair: pair[1].fitted.score)
    for count in range(1, len(state.effects) + 2):
        yield from [p for p in in_turn if len(p[1].fitted.effects) == count][: study.budget.front_runners]


def _near(study: Study, step: SelectionStep) -> list[RankedCandidate]:
    """The named candidates of a step that say something of the machine and gain about as much as the best of them."""
    named = (r for r in step.ranked if not r.unknown and r.gain > least_gain(r.fitted, study.settings))
    found = [r for r in named if sound(study, r)]
    most = max((r.gain for r in found), default=0.0)
    return [r for r in found if r.gain > study.settings.polish_share * most]
