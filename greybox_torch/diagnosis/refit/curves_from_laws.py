"""Free curves begun anew from a law of their own signal that goes farther than they do and is none of the machine's."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.curve import drawing, may_be_drawn
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged, sound
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.study import Study
from greybox_torch.simulation.side_by_side import side_by_side


def curves_from_laws(study: Study, parent: Hypothesis, ranked: Sequence[RankedCandidate]) -> list[RankedCandidate]:
    """The refits, those of free curves begun anew from a law that they contain, that goes farther, and that says nothing of the machine.

    A curve draws any law without memory of its signal at its port: what does not come as far has ended in a local minimum, and what it
    leaves says nothing of what else is missing. A law that says something is told itself. Seen: the
    pad under a hopper's foot that pushes and does not pull, of which a curve removed 90 % and a wave of the same position 99.4 %; a
    stiffness of the pad was told beside that curve (0.97).

    Args:
        parent: the hypothesis that they are compared with.
    """

    def begun_anew(curve: RankedCandidate) -> RankedCandidate:
        law = _farthest(study, curve, ranked)
        if law is None:
            return curve
        effect, limits = curve.candidate.attachment, study.budget.window_iterations
        study.working_on(f"refitting {effect.prefix} from {law.candidate.attachment.prefix}")
        start = drawing(law.fitted, law.candidate.attachment, effect, study.surroundings)
        fitted = fit(study, curve.fitted.effects, [start], law.fitted.fits[0], limits=limits)
        if fitted is None or fitted.score > curve.fitted.score:
            return curve
        return judged(curve.candidate, parent, fitted, study.settings)

    return side_by_side(partial(begun_anew, r) for r in ranked)


def _farthest(study: Study, curve: RankedCandidate, ranked: Sequence[RankedCandidate]) -> RankedCandidate | None:
    """The law that goes farthest of those that may not be told, that a curve contains and that go farther than it does; None for any
    other refit.
    """
    if not curve.unknown:
        return None
    least = curve.fitted.score - study.settings.score_tie
    drawn, around = curve.candidate.attachment, study.surroundings
    farther = (r for r in ranked if not r.unknown and r.fitted.score < least)
    contained = (r for r in farther if may_be_drawn(r.candidate.attachment, drawn, around))
    return min((r for r in contained if not sound(study, r)), key=lambda r: r.fitted.score, default=None)
