"""Why an estimation ended, in words."""

from __future__ import annotations

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
    nothing_free = "nothing to estimate: every parameter and initial state is fixed"

    @property
    def succeeded(self) -> bool:
        """Whether the result is an optimum."""
        return self in (Termination.converged, Termination.small_step, Termination.nothing_free)
