"""The named laws at the port of a leading free curve, refitted from what the curve has learned."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.curve import laws_on_curve
from greybox_torch.diagnosis.refit.order import in_both_orders, joined
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged, price_of_noise
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.refit.richer_forms import richer_forms
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.side_by_side import side_by_side


def laws_behind_curve(
    study: Study, current: Hypothesis, final: Sequence[RankedCandidate], frozen: frozenset[str]
) -> list[RankedCandidate]:
    """Where a free curve leads: the named laws of the same signal at the same port, refitted from what the curve has learned.

    Not those that have come as far as the curve by themselves.
    """
    best = min(final, key=lambda r: r.fitted.score, default=None)
    if best is None or not isinstance(best.candidate.attachment.mechanism, Unknown):
        return []
    within = best.fitted.score + study.settings.score_tie
    there = {identity_of(r.candidate.attachment) for r in final if r.fitted.score < within}

    def tried(candidate: Candidate) -> RankedCandidate | None:
        study.working_on(f"refitting {candidate.attachment.prefix} from the curve")
        effects = joined(current.effects, candidate)
        limits, shorter = study.budget.window_iterations, best.fitted.fits[0]
        fitted = fit(study, effects, candidate.starts, shorter, limits=limits, frozen=frozen)
        return None if fitted is None else judged(candidate, current, fitted, study.settings)

    laws = laws_on_curve(study.problem.model, best.fitted, best.candidate.attachment, study.surroundings, study.card)
    allowed = [
        law for law in laws if not study.beliefs.exclude(law.attachment) and identity_of(law.attachment) not in there
    ]
    tries = in_both_orders(study, current.effects, allowed)
    behind = [r for r in side_by_side(partial(tried, law) for law in tries) if r is not None]
    # A law that removes a part of it would else give way to the richer form of another one, at another port.
    in_part = [r for r in final if not r.unknown and 0.0 < r.gain < study.settings.named_share * best.gain]
    price = price_of_noise(best.fitted, study.settings)
    if any(r.gain - price * r.size > best.gain - price * best.size for r in in_part):
        return behind  # the curve leads by the noise that its many parameters take up

    def in_richer_forms(laws: Sequence[RankedCandidate]) -> list[RankedCandidate]:
        richer = richer_forms(study, best.candidate.attachment.port, [(r.candidate, r.fitted) for r in laws])
        forms = side_by_side(partial(tried, law) for law in richer)
        return [r for r in forms if r is not None and r.fitted.score < within]

    forms = in_richer_forms(in_part)
    # Beside the richer form of another law, one that comes nearer than that did in its plain form is asked in its own.
    names = {r.candidate.attachment.mechanism.name for r in forms}
    others = [r for r in final if not r.unknown and r.candidate.attachment.mechanism.name not in names]
    nearer = [r for r in others if r.gain >= study.settings.named_share * best.gain and r.fitted.score >= within]
    return [*behind, *forms, *(in_richer_forms(nearer) if forms else ())]
