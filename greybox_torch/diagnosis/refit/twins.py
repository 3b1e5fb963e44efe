"""Start values that a law takes over from its twin, from one akin to it, or from one that it contains.

A dead time is found from where the screen puts it, and of steps and reversals the error has a valley for every corner that a wrong delay
brings near another one. Two laws that do nearly the same, such as a delay of the input and one of the output, are screened apart, and one
may begin in the right valley and the other not: then they would be compared by where they began. So it is with a lag of the input and one
of the output, which nonlinear friction tells apart. And a law that ends worse than one that it contains has ended in a local minimum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.screen.shortlist import Candidate, contains
from greybox_torch.mechanisms.attachment import Attachment

Tried = tuple[Candidate, Hypothesis | None]


def from_twin(candidate: Candidate, reached: Hypothesis | None, tried: Sequence[Tried], tie: float) -> dict[str, float]:
    """The values that a law akin to a candidate came to in its trial, as start values of that; none where it is not clearly better.

    Args:
        reached: what the candidate came to itself, None where it could not be fitted.
        tried: candidates with what they came to.
        tie: difference of scores up to which two tie.
    """
    twins = {*candidate.attachment.mechanism.twins, *candidate.attachment.mechanism.akin}
    better = [
        (fitted.score, other, fitted.values())
        for other, fitted in tried
        if fitted is not None
        and other.attachment.mechanism.name in twins
        and (reached is None or fitted.score < reached.score - tie)
    ]
    if not better:
        return {}
    _, twin, values = min(better, key=lambda entry: entry[0])
    return renamed(values, f"{twin.attachment.prefix}.", f"{candidate.attachment.prefix}.")


def from_contained(
    candidate: Candidate, reached: Hypothesis | None, tried: Sequence[Tried], tie: float
) -> dict[str, float]:
    """The values that a law which a candidate contains came to at its port, as start values; none where it is not clearly better.

    Arguments as for :func:`from_twin`.
    """
    law, better = candidate.attachment, []
    for other, fitted in tried:
        inside = contains(law, other.attachment)
        if inside and fitted is not None and (reached is None or fitted.score < reached.score - tie):
            start = _as_contained(law, other.attachment, fitted)
            better += [(fitted.score, start)] if start else []
    return min(better, key=lambda entry: entry[0])[1] if better else {}


def _as_contained(law: Attachment, contained: Attachment, fitted: Hypothesis) -> dict[str, float]:
    """Start values of a law as the one that it contains, fitted as it is; none where the law does not know how."""
    inside = f"{contained.prefix}."
    own = contained.own(fitted.values())
    begun = {f"{law.prefix}.{n}": v for n, v in law.mechanism.begun_as(contained.mechanism.name, own).items()}
    rest = {n: v for n, v in fitted.values().items() if not n.startswith(inside)}
    return {**rest, **begun} if begun else {}


def renamed(values: Mapping[str, float], old: str, new: str) -> dict[str, float]:
    """The values by name, those whose names begin with ``old`` under names that begin with ``new``."""
    return {new + n.removeprefix(old) if n.startswith(old) else n: v for n, v in values.items()}
