"""Two laws in the place of a free curve of one signal, where neither comes near it alone.

Dry friction that is much larger in one direction is two laws, a level and a difference. Refitted with one of them, the model bends so far
to make up for the other that the second is not found beside it.
"""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.curve import two_laws_on_curve
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.forward_step import forward_step
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def with_first_of_two(
    study: Study, start: SearchState, with_curve: SearchState, *, line_open: bool = True
) -> SearchState | None:
    """``start`` with the first of the two laws that draw the curve of ``with_curve``, and both as what was found before.

    None where no two laws do. The step with the second, beside its rivals, is to be made from there (:func:`second_step`).
    ``line_open`` as for :func:`greybox_torch.mechanisms.matching_pairs.matching_pair`.
    """
    done = with_curve.steps[-1]
    if done.taken is None or len(with_curve.effects) >= study.budget.most_effects:
        return None
    curve = with_curve.current.effects[-1]
    found = two_laws_on_curve(study.problem.model, with_curve.current, curve, study.surroundings, line_open=line_open)
    if found is None or any(study.beliefs.exclude(law) for law in found[0]):
        return None
    laws, values = found
    study.working_on(f"refitting {laws[0].prefix} and {laws[1].prefix} from the curve")
    begun = [values, {**values, **study.card}]
    both = fit(study, (*start.effects, *laws), begun, with_curve.current.fits[0])
    if both is None or both.score >= start.current.score:
        return None
    return with_first(study, start, done, both)


def with_first(study: Study, start: SearchState, done: SelectionStep, both: Hypothesis) -> SearchState | None:
    """``start`` with the first of the two last laws of ``both``, as if ``done``, a step from there, had taken it, and both as found before.

    None where it cannot be fitted alone.
    """
    law, port = both.effects[-2], both.effects[-1].port
    first = _refitted_alone(done.ranked, law)
    if first is None:
        limits = study.budget.trial_iterations
        alone = fit(study, (*start.effects, law), [both.values()], done.parent.fits[0], limits=limits)
        if alone is None:
            return None
        explained = 0.0 if done.taken is None else done.taken.candidate.explained
        first = judged(Candidate(law, (), explained), start.current, alone, study.settings)
    # The place is known from both: what comes as far as one of the two laws elsewhere is no rival of both.
    there = (r for r in done.ranked if r.candidate.attachment.port == port and r is not first)
    ranked = (first, *(r for r in there if r.candidate.attachment.named != law.named))
    step = replace(done, ranked=ranked, taken=first, led=None)
    return replace(start.at(first.fitted), steps=(*start.steps, step), found_before=both)


def second_step(study: Study, first: SearchState) -> Stage[SearchState]:
    """The forward step from the first of two laws, the second with the values of both among its candidates."""
    both = first.found_before
    assert both is not None
    (law,) = (e for e in both.effects if e.prefix not in first.prefixes)
    known = judged(Candidate(law, (), 0.0), first.current, both, study.settings)
    return (yield from forward_step(study, replace(first, found_before=None), curves=False, known=[known]))


def _refitted_alone(ranked: tuple[RankedCandidate, ...], law: Attachment) -> RankedCandidate | None:
    """The refit of a law among those of a step; not one of the same name by another label, such as a ripple of another order."""
    return next((r for r in ranked if r.candidate.attachment.prefix == law.prefix), None)
