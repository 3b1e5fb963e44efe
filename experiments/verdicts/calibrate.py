"""Do the probabilities of the verdicts mean what they say? Reliability, Brier score, and the map that would make them right.

    python -m experiments.verdicts.calibrate OUT CASES VERDICTS [CASES VERDICTS …] [--page FILE --about TEXT]

Of names, of exact names (right where they are what was concealed itself, and no look-alike that the key accepts as well), of answers
(names that the key accepts are one), and of statements: the whole class (``one_of``) that a finding is told as, its own name where it
stands alone. The map p' = 1 / (1 + exp(−(a + b·logit p))) is fitted on all pairs of folders but the last, and tried on
the last (where there is one pair only, it is fitted on every other finding and tried on the rest). Writes OUT/calibration.json and
OUT/calibration.png, and with --page a page of what the last pair shows, with its figure beside it.

Source: J. C. Platt, "Probabilistic outputs for support vector machines", 1999; G. W. Brier, 1950.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from experiments.verdicts.answers import Claim
from experiments.verdicts.rates import Rate
from experiments.verdicts.scoring import Finding, score_all

EDGES = (0.0, 0.3, 0.5, 0.7, 0.9, 1.0)
STEPS = 100
NAMES, EXACT, ANSWERS, CLASSES = KINDS = ("names", "exact names", "answers", "classes")


def collect(folders: Sequence[Path], what: str = NAMES) -> tuple[np.ndarray, np.ndarray]:
    """Claimed probabilities (n,) of one of these kinds, over all pairs of folders, and whether each came true (n,)."""
    findings = [f for cases, verdicts in pairs_of(folders) for s in score_all(cases, verdicts) for f in s.findings]
    told = [claim for f in findings for claim in claims_of(f, what)]
    return np.array([p for p, _ in told], dtype=float), np.array([right for _, right in told], dtype=float)


def claims_of(finding: Finding, what: str) -> Sequence[Claim]:
    """Probability and truth of what a finding claims, of one of the ``KINDS``."""
    if what == ANSWERS:
        return finding.answers
    if what == CLASSES:
        return [(finding.class_probability, finding.class_right)]
    return [(finding.probability, finding.exact if what == EXACT else finding.right)]


def pairs_of(folders: Sequence[Path]) -> list[tuple[Path, Path]]:
    """Folders of cases with those of their verdicts."""
    return list(zip(folders[::2], folders[1::2], strict=True))


def fitted_map(claimed: np.ndarray, right: np.ndarray) -> tuple[float, float]:
    """(a, b) of largest likelihood, by Newton's method, with Platt's targets against certainty from few findings."""
    x = np.stack([np.ones_like(claimed), _logit(claimed)], axis=1)
    positive = right.sum()
    target = np.where(right > 0, (positive + 1) / (positive + 2), 1 / (len(right) - positive + 2))
    weight = np.array([0.0, 1.0])
    for _ in range(STEPS):
        p = 1 / (1 + np.exp(-x @ weight))
        curvature = x.T @ (x * (p * (1 - p))[:, None]) + 1e-3 * np.eye(2)
        weight = weight - np.linalg.solve(curvature, x.T @ (p - target) + 1e-3 * (weight - [0.0, 1.0]))
    return float(weight[0]), float(weight[1])


def mapped(claimed: np.ndarray, weights: tuple[float, float]) -> np.ndarray:
    return 1 / (1 + np.exp(-(weights[0] + weights[1] * _logit(claimed))))


def brier(claimed: np.ndarray, right: np.ndarray) -> float:
    return float(np.mean((claimed - right) ** 2)) if len(claimed) else float("nan")


def reliability(claimed: np.ndarray, right: np.ndarray) -> list[dict[str, float]]:
    """Per bin of claimed probability: how many findings, the mean claim, the share that is right, and its exact interval of 95 %."""
    rows = []
    for low, high in pairwise(EDGES):
        inside = (claimed > low) & (claimed <= high)
        if inside.any():
            lower, upper = Rate(int(right[inside].sum()), int(inside.sum())).interval
            rows.append(
                {
                    "findings": int(inside.sum()),
                    "claimed": float(claimed[inside].mean()),
                    "right": float(right[inside].mean()),
                    "lower": lower,
                    "upper": upper,
                }
            )
    return rows


def _logit(p: np.ndarray) -> np.ndarray:
    bounded = np.clip(p, 1e-3, 1 - 1e-3)
    return np.log(bounded / (1 - bounded))


def scored(folders: Sequence[Path], what: str) -> dict[str, Any]:
    """What is claimed against what is right, and the map, fitted on all pairs of folders but the last."""
    tested = collect(folders[-2:], what)
    if len(folders) > 2:
        fit_on, test_on = collect(folders[:-2], what), tested
    else:
        fit_on, test_on = (tested[0][::2], tested[1][::2]), (tested[0][1::2], tested[1][1::2])
    weights = fitted_map(*fit_on)
    result: dict[str, Any] = {"map": {"a": weights[0], "b": weights[1]}}
    for name, (p, r) in (("fitted on", fit_on), ("tested on", test_on)):
        result[name] = {
            "findings": len(p),
            "right": float(r.mean()) if len(r) else float("nan"),
            "brier": brier(p, r),
            "brier mapped": brier(mapped(p, weights), r),
            "reliability": reliability(p, r),
        }
    return result


def main(out: Path, folders: Sequence[Path], page: Path | None = None, about: str = "") -> None:
    from experiments.verdicts.calibration_page import draw, panels_of, write_page

    result = {what: scored(folders, what) for what in KINDS}
    out.mkdir(parents=True, exist_ok=True)
    (out / "calibration.json").write_text(json.dumps(result, indent=1) + "\n")
    draw(panels_of(result), out / "calibration.png")
    if page is not None:
        write_page(page, result, score_all(*folders[-2:]), about)
    print(json.dumps(result, indent=1))


def _parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m experiments.verdicts.calibrate")
    parser.add_argument("out", type=Path)
    parser.add_argument("folders", type=Path, nargs="+", metavar="CASES VERDICTS")
    parser.add_argument("--page", type=Path, help="a page in Markdown, its figure beside it")
    parser.add_argument("--about", default="", help="what the page says of the verdicts: which, of which commit")
    chosen = parser.parse_args()
    if len(chosen.folders) % 2:
        parser.error(f"expected pairs of folders, cases and verdicts; found {len(chosen.folders)} folders")
    return chosen


if __name__ == "__main__":
    given = _parsed()
    main(given.out, given.folders, given.page, given.about)
