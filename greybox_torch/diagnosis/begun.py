"""What the free runs of a verdict begin with, in a sentence."""

from __future__ import annotations

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.initial import BEGINNINGS


def begun(verdict: Verdict) -> str:
    """How the models of the table of scores begin; "" where the search was stopped before whole records were fitted."""
    return BEGINNINGS if verdict.complete and any(s.role == "estimation" for s in verdict.scores["refit"]) else ""
