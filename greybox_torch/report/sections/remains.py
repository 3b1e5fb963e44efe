"""What remains: how much of the mismatch the recommended model leaves, and the refinements, which are too small to be findings."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text


@dataclass(frozen=True)
class Refinement:
    """A row: what it would be called, where, its share of the whole mismatch in %, and why it is no finding."""

    mechanism: str
    port: str
    size: str
    why: str


@dataclass(frozen=True)
class Remains:
    """The sentences about what is left, and the rows of refinements."""

    sentence: str
    refinements: tuple[Refinement, ...]
    template: str = "remains.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Remains | None:
        if verdict.left is None:
            return None
        rows = (
            Refinement(text.words(e.mechanism), e.port, f"{digits(100 * e.size)} %", e.why_small)
            for e in sorted(verdict.refinements, key=lambda e: -e.size)
        )
        return cls(" ".join((verdict.left.sentence, *verdict.worse_outputs)), tuple(rows))
