"""Which of the candidates that were tried are refitted in full."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import at_floor
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.one_effect import twins_in
from greybox_torch.simulation.simulator import Simulator

Trial = tuple[float, Candidate, Hypothesis, Simulator]
"""How far a candidate came beyond the hypothesis before it (negative: better), the candidate, its trial, and its simulator."""


def finalists(first: list[Trial], study: Study) -> list[Trial]:
    """The best few, the best few named ones and what ties with the best of those, what they generalise, and the best curve.

    What is akin to one of them and ties with it is refitted too: a trial ends long before what tells a lag of the input from one of the
    output. Seen: a sensor's lag, told as the input's (0.97, 290 times the noise left), whose trials were 0.02 apart; in full they were 6.
    So is a twin, however its trial ended, where no recording tells the two apart.
    """
    named = [e for e in first if not e[1].unknown]
    chosen = first[: study.budget.finalists]
    tied = [e for e in named[: study.budget.most_tied] if e[0] < named[0][0] + study.settings.score_tie]
    chosen += [e for e in named[: max(study.budget.finalists, len(tied))] if e not in chosen]
    chosen += [e for e in named if e not in chosen and any(_close_kin(study, e, c) for c in chosen)]
    contained = {(e[1].attachment.port, name) for e in chosen for name in e[1].attachment.mechanism.generalises}
    chosen += [e for e in first if e[1].attachment.named in contained and e not in chosen]
    if not any(e[1].unknown for e in chosen):
        chosen += [e for e in first if e[1].unknown][:1]
    return chosen


def _close_kin(study: Study, one: Trial, other: Trial) -> bool:
    """Whether two trials of laws that do nearly the same tie, or no recording tells their laws apart."""
    law, own = other[1].attachment.mechanism, one[1].attachment.mechanism.name
    tied = own in {*law.twins, *law.akin} and one[0] < other[0] + study.settings.score_tie
    return tied or _twins(study, one, other)


def _twins(study: Study, one: Trial, other: Trial) -> bool:
    return other[1].attachment.mechanism.name in twins_in(study.problem.model, one[1].attachment.mechanism)


def leading_and_rest(study: Study, entries: Sequence[Trial]) -> list[list[Trial]]:
    """Those whose trial came within reach of the best, and the others.

    Where a named one came to the noise, no other name that is clearly behind it can still win; a curve is what it is measured against.
    Twins go together.
    """
    settings = study.settings
    best = min((entry[0] for entry in entries), default=0.0)
    reach = named_reach = settings.finalist_share * best + settings.trial_allowance
    if any(not c.unknown and at_floor(study.problem, trial.fits[-1], settings) for _, c, trial, _ in entries):
        named_reach = min(reach, best + settings.trial_allowance + settings.score_tie)
    near = [entry for entry in entries if entry[0] <= (reach if entry[1].unknown else named_reach)]
    near += [entry for entry in entries if entry not in near and any(_twins(study, entry, one) for one in near)]
    return [near, [entry for entry in entries if entry not in near]]
