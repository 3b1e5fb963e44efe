"""Everything that the page says, as JSON for scripts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from experiments.concealed.proof.promises import Promise
from experiments.concealed.proof.protocol import Proof
from experiments.concealed.proof.reasons import reasons
from experiments.verdicts.scoring import Scored


def results(proof: Proof, found: Sequence[Scored], kept: Sequence[Promise]) -> dict[str, Any]:
    """Everything that the page says, for scripts."""
    sealed = proof.record.sealed or {}
    about = {name: sealed[name] for name in ("set", "seed", "commitment", "rules", "tool", "time")}
    return {
        "schema": "greybox-proof/1",
        **about,
        "promises": [{"what": p.what, "wanted": p.wanted, "measured": p.measured, "kept": p.kept} for p in kept],
        "cases": [
            {
                "case": r.name,
                "machine": r.key["machine"],
                "section": r.key["section"],
                "effects": list(r.effects),
                "strength": r.strength,
                "visibility": r.key["visibility"],
                "said": r.said,
                "detected": r.detected,
                "located": r.located,
                "named": r.named,
                "spurious": r.spurious,
                "closed": r.closed,
                "seconds": r.seconds,
                "reasons": reasons(r),
            }
            for r in found
        ],
    }
