"""Why an estimation ended, in words."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Termination(Enum):
    """Each value says what happened and, where it is a failure, what to try."""

    converged = "converged: the cost no longer changes"
    small_step = "converged: the parameters no longer change"
    stalled = (
        "stalled: no step lowers the cost; try other start values, or fix parameters that the data do not determine"
    )
    iteration_limit = (
        "stopped at the iteration limit before converging; try to go on from these values (`greybox fit DATASET.toml --checkpoint "
        "RESULTS`, in Python fit(result, data)), or fix parameters that the data hardly determine"
    )
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
