"""What a finding claims of each answer, names that the key takes for one answer being one.

A bias of the drive and a constant force are the same to a machine with one input: a verdict that gives each 0.48 has said 0.96, and a key
that takes either for right has to count it so. The score is half the sum of squares over all answers (G. W. Brier, Monthly Weather Review
78, 1950, whose score it is the half of): of two answers it is the usual squared difference. It is lowest where claims are what one
believes, and it does not favour names that were right: whatever is claimed of wrong ones counts against it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

Pair = tuple[str, str]
Claim = tuple[float, bool]


def hypotheses(effect: Mapping[str, Any]) -> dict[Pair, float]:
    """The probabilities of all hypotheses of one finding, by port and mechanism."""
    members = (effect.get("one_of") or {}).get("members", ())
    listed = [*effect.get("alternatives", ()), *(m for m in members if "probability" in m), effect]
    return {(e["port"], e["mechanism"]): float(e["probability"]) for e in listed}


def claims(effect: Mapping[str, Any], accepted: Collection[Pair]) -> tuple[Claim, ...]:
    """Probability and truth of every answer of a finding: what the key accepts is one answer, every other name one of its own.

    Args:
        accepted: the names that are right; none where the finding is spurious.
    """
    given = hypotheses(effect)
    right = [p for pair, p in given.items() if pair in accepted]
    wrong = [(p, False) for pair, p in given.items() if pair not in accepted]
    return ((sum(right), True), *wrong) if right else tuple(wrong)


def half_brier(said: Collection[Claim]) -> float:
    """Half the sum of squared differences between what was claimed of all answers and the truth, from 0 to 1.

    What the claims leave is claimed of "none of these", which is the truth where none of them is right.
    """
    other = max(0.0, 1.0 - sum(p for p, _ in said))
    none_right = not any(right for _, right in said)
    return 0.5 * (sum((p - right) ** 2 for p, right in said) + (other - none_right) ** 2)
