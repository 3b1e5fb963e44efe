"""By which power of their weights do a finding and its rivals share a probability best? What `share_exponent` is chosen by.

    python -m experiments.verdicts.share_power CASES VERDICTS [CASES VERDICTS …]

Raises the probabilities of the verdicts to further powers, one being what was told, and scores them: of names and, as one that is lowest
where claims are what one believes, of answers. Findings whose probability was capped keep it.
"""

from __future__ import annotations

import argparse
import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.verdicts.calibrate import pairs_of
from experiments.verdicts.scoring import Finding, Scored, score, score_all
from experiments.verdicts.totals import brier_of, brier_of_answers
from greybox_torch.diagnosis.settings import DiagnosisSettings

POWERS = (0.5, 0.75, 1.0, 1.5, 2.0)
UNLISTED = 0.03
"""What rivals that are too unlikely to be listed may have together."""


def raised(effect: Mapping[str, Any], power: float) -> dict[str, Any]:
    """An effect of a verdict whose probability and its rivals' are raised to a power, their sum kept; as it is where it was capped."""
    found = copy.deepcopy(dict(effect))
    rivals = found["alternatives"]
    total = found["probability"] + sum(r["probability"] for r in rivals)
    if not rivals or total < DiagnosisSettings().highest_probability - UNLISTED:
        return found
    members = (found.get("one_of") or {}).get("members", [])
    whole = found["probability"] ** power + sum(r["probability"] ** power for r in rivals)
    for told in (found, *rivals, *(m for m in members if "probability" in m)):
        told["probability"] = total * told["probability"] ** power / whole
    return found


def scored_at(cases: Sequence[Scored], power: float) -> tuple[float, float]:
    """Brier scores of names and of answers, with probabilities raised to a power."""
    findings: list[Finding] = []
    for case in (c for c in cases if c.verdict is not None):
        assert case.verdict is not None
        verdict = {**case.verdict, "effects": [raised(e, power) for e in case.verdict["effects"]]}
        findings += score(case.name, verdict, case.key).findings
    return brier_of(findings), brier_of_answers(findings)


def main(folders: Sequence[Path]) -> None:
    print("| verdicts | " + " | ".join(f"power {p:g}" for p in POWERS) + " |\n|---|" + "---|" * len(POWERS))
    for cases, verdicts in pairs_of(folders):
        known = score_all(cases, verdicts)
        scores = (scored_at(known, power) for power in POWERS)
        print(f"| {verdicts} | " + " | ".join(f"names {n:.4f}, answers {a:.4f}" for n, a in scores) + " |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m experiments.verdicts.share_power")
    parser.add_argument("folders", type=Path, nargs="+", metavar="CASES VERDICTS")
    chosen = parser.parse_args()
    if len(chosen.folders) % 2:
        parser.error(f"expected pairs of folders, cases and verdicts; found {len(chosen.folders)} folders")
    main(chosen.folders)
