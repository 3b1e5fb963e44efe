"""Where free runs leave what windows do not show, a slow effect is looked for over longer windows.

Over a window the start states take up whatever acts slowly: a constant force moves an inertia by the square of the time. Free runs show it;
they also show how disturbances of the machine add up where nothing pulls it back. So what longer windows find has to explain most of it on
experiments that had no part in choosing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from greybox_torch.diagnosis.confirm.hardly_followed import hardly_followed
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.same_everywhere import CHANCE, CHANCE_FAR_ABOVE, is_offset, same_everywhere
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, window_lengths
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.degenerate import periods

Judged = tuple[SearchState, Mapping[str, Gain], Judgement]
"""What a search found, what its effects gain on held-out experiments, and its free runs."""


def longer_windows(study: Study, state: SearchState, judged: Judgement, searched: Hypothesis) -> SearchBudget | None:
    """The budget with windows twice as long beside the others.

    None where free runs leave little, or windows show it, or none are longer. Little is what disturbances may leave and nobody sees. Where
    nothing was found and free runs hardly follow, windows of half the longest record, whatever shorter ones show: short records have no
    windows in which anything slow shows.

    Args:
        searched: what the search came to, before held-out experiments judged: where it leaves noise alone over windows, free runs may have
            taken something of it back for what acts slowly beside it.
    """
    settings, budget = study.settings, study.budget
    share, times, _ = judged.left(bool(state.effects))
    if not (times > settings.far_above_noise and share > settings.slow_share):
        return None
    if times < settings.far_above_disturbances and judged.mismatch_share < settings.obvious_mismatch:
        return None
    lost = not state.effects and hardly_followed(judged)
    by_windows = (times_noise(study.problem, h, settings) for h in (state.current, searched))
    if not lost and min(by_windows) > settings.above_noise:
        return None
    lengths = window_lengths(study.problem, budget)
    factors = budget.window_factors[: len(lengths)]  # short records have no windows of the others
    last = int(study.problem.records.lengths.max()) // 2 // lengths[0] if lost else 2 * factors[-1]
    longer = replace(budget, window_factors=(*factors, last))
    return longer if len(window_lengths(study.problem, longer)) > len(lengths) else None


def stands(study: Study, before: Judged, after: Judged) -> bool:
    """Whether what longer windows found is a finding: it explains the free runs, held-out windows bear it out beyond chance, and what is
    constant is the same in every experiment. Less is asked where free runs hardly follow without it.

    Args:
        study: of ``after``.
    """
    state, gains, judged = after
    new = [e for e in state.effects if e.prefix not in before[0].prefixes]
    settings = study.settings
    lost = not before[0].effects and hardly_followed(before[2])
    least = settings.least_held_out if lost else settings.held_out_beyond_chance
    most = settings.most_of_the_mismatch if lost else settings.slow_share
    sure = all(gains[e.prefix].errors_away > least for e in new if e.prefix in gains)
    explained = bool(state.effects) and sure and explains_free_runs(before[2], judged, settings, most)
    return explained and all(constant_effect(study, state, judged, e, lost) for e in new)


def constant_effect(
    study: Study, state: SearchState, judged: Judgement, effect: Attachment, lost: bool = False
) -> bool:
    """Whether an effect of ``state``, whose free runs are ``judged``, is the same in every experiment.

    ``lost``: free runs hardly follow without what was found. Then a law that is no offset may scatter as constants of machines do: a drift
    that takes its course over time in each experiment is less likely than one of the same mean. Seen: a real heater's loss, 0.0159 and
    0.0151 W/K in its two experiments, by which the fit of the validation experiment rises from -11 to 90 %: "without a name".
    """
    around = study.surroundings[effect.port]
    if _another_offset_in_each(study, state, effect):
        return False
    chance = CHANCE_FAR_ABOVE if lost and not is_offset(effect.mechanism) else CHANCE
    return same_everywhere(state.current, judged.problem, around, effect, study.budget, judged.begun, chance)


def _another_offset_in_each(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether an effect is a long wave over a position that no sensor shows: where that begins is placed for every experiment, so that it
    may stand for another offset in each. Seen: a complete arm that drifts, told as a ripple of two periods over all that it travelled
    (0.97), 23 % of six times the noise left.
    """
    current = state.current
    order = current.values().get(f"{effect.prefix}.order")
    if order is None or not current.model.start_trials(current.problem.values):
        return False
    return periods(order, study.surroundings[effect.port]) < study.settings.least_periods


def explains_free_runs(before: Judgement, after: Judgement, settings: DiagnosisSettings, most: float) -> bool:
    """Whether the effects of ``after`` leave at ``most`` that share of what ``before`` leaves of free runs, so that most of it is theirs.

    By experiments that had no part in choosing either: those that judge ``after``, which may have taken one more to choose with. Where they
    show next to nothing of what is missing (a stop that is never reached there), by the ones that were taken. What the model as it stands
    explains once it is estimated from those, too, is none of the effects' doing.
    """
    counting, taken = after.judges - after.unstable, before.judges - after.judges
    if taken and before.mismatch(True, counting) < settings.least_size * before.mismatch(True, taken):
        counting = taken
    least = min(before.mismatch(True, counting), after.mismatch(False, counting))
    return after.mismatch(True, counting) <= most * least


def sentence(before: Judgement, state: SearchState, searched: Hypothesis, longer: SearchState) -> str:
    """What the reader of a verdict has to know of it.

    Args:
        state: what was left of what was ``searched`` before, ``longer`` over longer windows.
    """
    _, times, experiment = before.left(bool(state.effects))
    shown, then = (s.current.fits[-1].windows.steps for s in (state, longer))
    if not state.effects and hardly_followed(before):
        return (
            f"Free runs hardly follow the validation experiments without effects ({times:.2g} times the noise in {experiment}): windows of "
            f"{then} samples were searched, too, beside those of up to {shown}."
        )
    if len(searched.effects) > len(state.effects):
        return (
            f"Over windows of up to {shown} samples what was found first left hardly more than noise, and was taken back: what acts slowly "
            f"beside it was looked for over windows of {then} samples, too."
        )
    return (
        f"Free runs of what was found before leave {times:.2g} times the noise in {experiment}, which windows of up to {shown} samples "
        f"do not show: what acts slowly was looked for over windows of {then} samples, too."
    )
