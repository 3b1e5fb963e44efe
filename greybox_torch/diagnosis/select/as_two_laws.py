"""One law told as two that do as well and have no more parameters.

Friction that is larger in one direction and friction beside a constant force differ only at rest. Told as one law where recordings do not
show that, a wrong name is sure. As two laws friction is, and the other is one statement of all that it may be: a constant force, an input's
offset, a difference of the levels. Seen: a pendulum's motor with an offset and dry friction at its pivot, told as uneven friction (0.97).
"""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import overall_significance
from greybox_torch.diagnosis.refit.curve import values_without
from greybox_torch.diagnosis.refit.likelihood import needed_by_likelihood
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.two_laws import second_step, with_first
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def as_two_laws(study: Study, before: SearchState, after: SearchState) -> Stage[SearchState]:
    """``after`` with two laws in the place of the newest one, where these do as well; as it is elsewhere."""
    done = after.steps[-1]
    if done.taken is None or len(after.effects) >= study.budget.most_effects:
        return after
    both = two_in_its_place(study, done.taken.fitted, done.taken.candidate.attachment)
    first = None if both is None else with_first(study, replace(before, plain=after.plain), done, both)
    if first is None:
        return after
    two = yield from second_step(study, first)
    return two if len(two.effects) > len(first.effects) else after


def two_in_its_place(study: Study, one: Hypothesis, law: Attachment) -> Hypothesis | None:
    """The hypothesis ``one`` with two laws in the place of ``law``, where they nearly do as well; they are its last effects, in turn.

    None elsewhere, and where two have more parameters.
    """
    parts = law.mechanism.as_two(law.own(one.values()))
    laws = [replace(law, mechanism=mechanism) for mechanism, _ in parts]
    others = tuple(e for e in one.effects if e != law)
    there = {e.named for e in others}
    if not laws or any(study.beliefs.exclude(part) or part.named in there for part in laws):
        return None
    study.working_on(f"refitting {law.prefix} as {laws[0].prefix} and {laws[1].prefix}")
    begun = {f"{part.prefix}.{n}": v for part, (_, own) in zip(laws, parts, strict=True) for n, v in own.items()}
    two = fit(study, (*others, *laws), [values_without(one, law) | begun], one.fits[0])
    if two is None or two.problem.free.sum() > one.problem.free.sum():
        return None
    return None if _tells(study, two, one) else two


def _tells(study: Study, two: Hypothesis, one: Hypothesis) -> bool:
    """Whether the recordings tell one law from two: by its score, by windows beyond chance, or by the likelihood of whole records.

    Seen: an excavator's boom, 420 N m up and 120 N m down, 15 standard errors from dry friction and a constant force.
    """
    settings = study.settings
    if two.score - one.score >= settings.score_tie:
        return True
    by_chance = overall_significance(two, one, settings) < settings.least_significance
    return not by_chance or needed_by_likelihood(two, one, settings)
