"""Values of a law that say something of the machine: where a law stands with its best values alone, and where with the best of those."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import window_significance
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged, sound
from greybox_torch.diagnosis.select.remaining import completes
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study


def tellable(study: Study, ranked: Sequence[RankedCandidate]) -> list[RankedCandidate]:
    """Those of ``ranked`` whose values say something of the machine, but for laws that complete the model with values that say nothing.

    Where neither do, more is missing, and which values go farther may change with that.
    Seen: a notch of a pivot, told as a ripple of six waves that repeats 2.1 times in the travel (0.95); six that repeat 1.3 times, and so
    draw any curve, left noise alone where that left 1.3 times as much.
    """
    told = [(r, sound(study, r)) for r in ranked]
    rest = [r for r, says in told if not says]
    return [r for r, says in told if says and (r.unknown or not any(_refuted(r, o, study.settings) for o in rest))]


def with_values_that_say_something(
    study: Study, parent: Hypothesis, polished: Sequence[RankedCandidate], before: Sequence[RankedCandidate]
) -> tuple[RankedCandidate, ...]:
    """``polished``, best first, of which a law whose values say nothing of the machine has those that it had ``before``, if they do.

    For laws that were known before a step, as in the place of a free curve, which shows that more than one may be missing: beside what
    still is, values that are nobody's may go farther. Seen: a drive's limit of 1.15 N m, beside the drag of its rotor that was missing
    as well, led from 1.5 to the end of what it may be; the two were told as an unknown effect at the actuator (0.97).

    Args:
        parent: what all are compared with.
    """

    def kept(r: RankedCandidate) -> RankedCandidate:
        if sound(study, r):
            return r
        other = next((one for one in before if one.candidate is r.candidate and sound(study, one)), None)
        return r if other is None else judged(r.candidate, parent, other.fitted, study.settings)

    best = [kept(r) for r in polished]
    changed = any(one is not other for one, other in zip(best, polished, strict=True))
    return tuple(in_order(best, study.settings)) if changed else tuple(polished)


def _refuted(law: RankedCandidate, other: RankedCandidate, settings: DiagnosisSettings) -> bool:
    """Whether ``other`` is the same law with values that leave noise alone, and go farther than a tie, beyond chance."""
    same = law.candidate.attachment.named == other.candidate.attachment.named
    if not same or other.size > law.size or other.fitted.score > law.fitted.score - settings.score_tie:
        return False
    farther = window_significance(law.fitted, other.fitted, settings) > settings.least_significance
    return farther and completes(other.fitted, settings)
