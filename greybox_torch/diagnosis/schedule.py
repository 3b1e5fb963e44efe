"""How the seconds of a limited diagnosis are shared among its stages, so that the answer stands when they are over."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis.settings import SearchBudget


@dataclass(frozen=True)
class Schedule:
    """When each stage has to end: the search, the confirmation on held-out experiments, the final fits, and what may be taken back.

    What follows then (describing what was found, writing it) needs no more than what is kept for it.
    """

    searching: Deadline = Deadline()
    confirming: Deadline = Deadline()
    fitting: Deadline = Deadline()
    judging: Deadline = Deadline()

    @staticmethod
    def within(end: Deadline, comparison: float, budget: SearchBudget) -> Schedule:
        """For what is left until ``end``.

        Args:
            comparison: seconds that one model takes to be compared with all experiments (see :class:`FreeRuns`). The re-estimated model
                and the one with effects, which has more states, are still to be compared, and what was found described.
        """
        if not end.limited:
            return Schedule()
        writing = budget.seconds_for_writing
        kept = writing + budget.comparisons_to_come * comparison
        shared = max(end.left - kept, 0.0)
        fitting = Deadline(end.at - kept)
        confirming = Deadline(fitting.at - budget.share_for_final_fits * shared)
        return Schedule(
            searching=Deadline(confirming.at - budget.share_for_confirming * shared),
            confirming=confirming,
            fitting=fitting,
            judging=Deadline(end.at - writing),
        )
