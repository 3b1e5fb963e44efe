"""The sentences that the verdict rests on."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.verdict import Verdict


@dataclass(frozen=True)
class Evidence:
    sentences: tuple[str, ...]
    template: str = "evidence.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Evidence | None:
        return cls(tuple(verdict.evidence)) if verdict.evidence else None
