"""What is left of a selection once it is fitted to whole records and free runs of the validation experiments have judged it.

A time limit or Ctrl-C cuts the final fits and the judgement short as the stages before them. What a verdict cannot be without (the
comparison of the model as it stands with all experiments) has no limit; it is begun once more where Ctrl-C interrupted it, and a second
Ctrl-C there ends the diagnosis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from greybox_torch.deadline import Deadline, until
from greybox_torch.diagnosis.confirm.beyond_free_runs import said_of_the_curve
from greybox_torch.diagnosis.confirm.curve_beside_laws import sized_by_free_runs
from greybox_torch.diagnosis.confirm.curve_instead import curve_instead
from greybox_torch.diagnosis.confirm.far_better import Standing
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.holding import Judged, holding, passed_over
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.less_than_is_left import less_than_is_left
from greybox_torch.diagnosis.confirm.memory_instead import memory_instead
from greybox_torch.diagnosis.confirm.refitted_laws import chosen_by_free_runs
from greybox_torch.diagnosis.confirm.shown_by_free_runs import shown_by_free_runs
from greybox_torch.diagnosis.confirm.sizes import sizes
from greybox_torch.diagnosis.confirm.standing import why_refinements
from greybox_torch.diagnosis.confirm.too_little import without_too_little
from greybox_torch.diagnosis.confirm.when_stopped import found_first
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.hypothesis.final import Final, finish, from_longest_windows
from greybox_torch.diagnosis.select.all_that_is_left import LeftInFreeRuns
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.selection import Selection
from greybox_torch.diagnosis.stopping import or_else
from greybox_torch.diagnosis.stopwatch import Stopwatch
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.comparison import mean_fit
from greybox_torch.simulation.side_by_side import side_by_side

FITTING = "final fits on whole records"
JUDGING = "validation and report data"


@dataclass(frozen=True, kw_only=True)
class Findings(Selection):
    """A selection of which free runs bear out what is left, and what they say of it.

    ``by_parameters``: the effect of the state where the recordings do not show it, and the re-estimated parameters do.
    """

    judged: Judgement
    by_parameters: Effect | None = None

    @property
    def sums(self) -> tuple[float, float]:
        """Mean squared errors without the effects and with them, summed over experiments; over the longest windows if those alone
        judge."""
        if not self.judged.by_windows_alone:
            return self.judged.sums
        state, experiments = self.state, len(self.study.problem.records.first)
        return experiments * state.plain.fits[-1].mean_square, experiments * state.current.fits[-1].mean_square

    @property
    def left(self) -> LeftInFreeRuns:
        """What the effects leave in free runs of the validation experiments; over the longest windows if those alone judge."""
        before, after = self.sums
        share = after / before if np.isfinite(before) and before > 0 else 0.0
        if self.judged.by_windows_alone:
            return LeftInFreeRuns(share, self.judged.missed, 0.0, self.state.by_free_runs)
        times, fit = self.judged.left(True)[1], mean_fit(self.judged.judging(self.judged.with_effects).scores)
        return LeftInFreeRuns(share, self.judged.missed, times, self.state.by_free_runs, fit)

    @property
    def removed(self) -> float:
        """The share of the validation error beyond the noise that the effects remove; of that over the longest windows if those alone
        judge, beyond what is left over the shortest."""
        if not self.judged.by_windows_alone:
            return min(1.0, max(0.0, 1.0 - self.judged.left(True)[0]))
        before, after = self.sums
        floor = len(self.study.problem.records.first) * min(f.mean_square for f in self.state.current.fits)
        return min(1.0, max(0.0, (before - after) / max(before - floor, 1e-300)))


def judge(selection: Selection, clock: Stopwatch) -> Findings:
    """Fit the model as it stands and the one with effects to whole records, and take back what free runs do not bear out."""
    study, state, others = selection.study, selection.state, selection.others
    (plain, augmented), fitted = _finished(study, state, selection.schedule.fitting)
    clock.lap(FITTING)
    work = partial(_judged, selection, plain, augmented)
    (state, gains, judged, said, held), whole = or_else(work, work)
    (state, gains, judged), why = without_too_little(state, gains, judged, study.settings)
    clock.lap(JUDGING)
    ended = {FITTING: fitted, JUDGING: held and whole}
    cut = (*selection.cut, *(stage for stage, whole in ended.items() if not whole))
    told: dict[str, Any] = {"state": state, "gains": gains, "complete": not cut, "cut": cut, "judged": judged}
    told |= {"others": None if cut else others, "more": (*selection.more, *said, *why)}
    return Findings(**vars(selection) | told)


def _finished(study: Study, state: SearchState, deadline: Deadline) -> tuple[tuple[Final, Final], bool]:
    """The model as it stands and the one with effects, fitted to whole records; as windows have them, where that was stopped."""

    def fits() -> tuple[Final, Final]:
        study.working_on("fitting whole records")
        fitted = partial(finish, settings=study.settings, budget=study.budget, records=study.recorded)
        if not state.effects:
            plain = fitted(state.plain)
            return plain, plain
        plain, augmented = side_by_side([partial(fitted, state.plain), partial(fitted, state.current)])
        return plain, augmented

    def as_they_are() -> tuple[Final, Final]:
        plain = from_longest_windows(state.plain)
        return plain, from_longest_windows(state.current) if state.effects else plain

    with until(deadline):
        return or_else(fits, as_they_are)


def _judged(selection: Selection, plain: Final, augmented: Final) -> Judged:
    """Effects taken back, the weakest first, until those left hold on the validation experiments, and whether there was time for that.

    Where there is none, what was found first is left if that holds by itself, else nothing. Where none holds, or little, a free curve may,
    or else laws that were passed over, or an unknown that remembers.
    """
    study, state, others = selection.study, selection.state, selection.others
    study.working_on("judging on the validation experiments")
    judged = Judgement.of(selection.free_runs, plain)
    if state.effects:
        judged = judged.having(augmented, {} if others is None else others.places(state.current))
    instead, whole, said = None, True, ()
    with until(selection.schedule.judging):
        found, _ = or_else(lambda: holding(study, state, others, selection.gains, judged), lambda: None)
        if found is not None and _curve_is_asked(state, found):
            instead, said, whole = _instead(study, state, others, found)
    if found is None:
        return found_first(study, state, judged)  # free runs of its own, for which time was left beyond that
    if instead is not None:
        return (*instead, (*found[3], *said), whole)
    told = {sentence.partition(" removes ")[0] for sentence in found[3]}  # of which effects
    found = (*found[:3], (*found[3], *(s for s in said if s.partition(" removes ")[0] not in told)), found[4])
    with until(selection.schedule.judging):
        sized, in_time = or_else(partial(sized_by_free_runs, study, found[0], others, *found[1:3]), lambda: found[1])
    return (found[0], sized, *found[2:4], found[4] and whole and in_time)


def _instead(
    study: Study, searched: SearchState, others: HeldOut | None, found: Judged
) -> tuple[Standing | None, tuple[str, ...], bool]:
    """What free runs bear out in the place of what was ``found``: a free curve, or in that of nothing laws, or an unknown that remembers;
    what a reader has to know of it, and whether there was time to ask.
    """
    state, _, judged, *_ = found
    instead, whole = or_else(partial(curve_instead, study, state, others, judged), lambda: None)
    if instead is None and whole and not state.effects:
        instead, whole = or_else(partial(passed_over, study, state, others, judged), lambda: None)
        if instead is not None:
            return instead, (chosen_by_free_runs(instead, state, judged),), whole
    if instead is None and whole and not state.effects:
        instead, whole = or_else(partial(memory_instead, study, searched, others, judged), lambda: None)
    said = ()
    if instead is None and whole and not state.effects:
        said, whole = or_else(partial(said_of_the_curve, study, searched, others, judged), tuple)
    return instead, said, whole


def _curve_is_asked(searched: SearchState, found: Judged) -> bool:
    """Whether nothing lasted, or so little of the names for a curve that much is left of the mismatch.

    Seen: what evaporates from a bath, told as a flow above a threshold and a constant: no threshold was there, and the constant alone left
    28 times the noise.
    """
    state, _, judged, *_ = found
    if not state.effects:
        return True
    lost = searched.prefixes - state.prefixes
    return bool(lost) and not state.has_curve and judged.left(True)[0] > judged.settings.left_to_ask_for_a_curve


def small_ones(found: Findings, by_effect: Mapping[str, float]) -> dict[str, str]:
    """Why effects are refinements, a clause each: those that windows say are too small, and those that are less than what free runs leave.

    Args:
        by_effect: the size of every effect.
    """
    study, state = found.study, found.state
    small = why_refinements(study, state, found.others, found.gains, by_effect)
    return less_than_is_left(state, by_effect, found.judged, study.settings) | small


def without_refinements_alone(found: Findings) -> Findings:
    """``found``, without effects where all of them are refinements that free runs do not need: such alone are none of the machine's.

    What windows show little of may be slow, and the same effect a finding over longer ones. Seen: uptake of glucose that saturates, a curve
    that was 39 % of the held-out error over windows of an eighth of the record, within chance, and 83 % over those of a quarter.
    """
    study, state = found.study, found.state
    if not state.effects or small_ones(found, sizes(study, state, found.gains)).keys() != state.prefixes:
        return found
    if shown_by_free_runs(study, state, found.gains, found.judged):
        return found
    return replace(found, state=state.at(state.plain), gains={}, judged=found.judged.without_effects())
