"""Why an estimation ended, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum


class Termination(Enum):
    """Each value says what happened and, where it is a failure, what to try."""

    converged = "converged: the cost no longer changes"
    small_step = "converged: the parameters no longer change"
    stalled = (
        "stalled: no step lowers the cost; try other start values, or fix parameters that the data do not determine"
    )
    iteration_limit = "stopped at the iteration limit before converging; try more iterations"
    overflow = (
        "failed: the simulation overflows at the start values; try start values nearer to the truth, tighter bounds, "
        "or a smaller sample time"
    )
    rank_deficient = (
        "rank deficient: the data do not determine all parameters; try to fix one of those that cannot be told apart, "
        "or record an experiment that excites the machine more"
    )
    at_bound = (
        "ended at a bound, where standard deviations mean little; try wider bounds where physics allows, and otherwise "
        "ask what the model lacks that drives the parameter there"
    )
    nothing_free = "nothing to estimate: every parameter and initial state is fixed"


@dataclass(frozen=True)
class Outcome:
    """What happened, and to what: ``detail`` names the time and the experiment, or the parameters."""

    kind: Termination
    detail: str = ""

    @property
    def sentence(self) -> str:
        """What happened with its detail, then what to try."""
        what, separator, suggestion = self.kind.value.partition("; ")
        return f"{what} ({self.detail}){separator}{suggestion}" if self.detail else self.kind.value


def listed(names: Sequence[str], conjunction: str = "and") -> str:
    """'a', 'a and b', 'a, b and c'."""
    return f" {conjunction} ".join([*filter(None, [", ".join(names[:-1])]), *names[-1:]])


MOST_NAMES = 6
"""Names that a list in a sentence has at most."""

_START = " at the start of "


def brief(names: Sequence[str]) -> str:
    """:func:`listed`, with the start states of several experiments as one entry, and of more than MOST_NAMES names the first."""
    states: dict[str, list[str]] = {}
    for name in names:
        state, _, _ = name.partition(_START)
        states.setdefault(state if _START in name else name, []).append(name)
    entries = [
        f"{state}{_START}{len(of)} experiments" if len(of) > 2 else entry
        for state, of in states.items()
        for entry in (of if len(of) <= 2 else of[:1])
    ]
    if len(entries) > MOST_NAMES:
        return f"{', '.join(entries[: MOST_NAMES - 1])} and {len(entries) - MOST_NAMES + 1} more"
    return listed(entries)
