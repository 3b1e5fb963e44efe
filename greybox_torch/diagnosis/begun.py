"""What the free runs of a verdict begin with, in a sentence."""

from __future__ import annotations

from greybox_torch.diagnosis.verdict import Verdict

WITH_THE_ESTIMATE = (
    "On estimation experiments the re-estimated models are begun with start states that are estimated along with their parameters; all "
    "else, as in `greybox compare`, with start states estimated on the first tenth. Start states that the card fixes are as it has them."
)


def begun(verdict: Verdict) -> str:
    """How the models of the table of scores begin; "" where the search was stopped before whole records were fitted."""
    return (
        WITH_THE_ESTIMATE if verdict.complete and any(s.role == "estimation" for s in verdict.scores["refit"]) else ""
    )
