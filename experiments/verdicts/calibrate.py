"""Do the probabilities of the verdicts mean what they say? Reliability, Brier score, and the map that would make them right.

    python -m experiments.verdicts.calibrate OUT CASES VERDICTS [CASES VERDICTS]

Of names, and of statements: the whole class (``one_of``) that a finding is told as, its own name where it stands alone. The map
p' = 1 / (1 + exp(−(a + b·logit p))) is fitted on the first pair of folders; both pairs are scored with it (where there is one pair only,
the map is fitted on every other finding and scored on the rest). Writes OUT/calibration.json, OUT/reliability.png and OUT/classes.png.

Source: J. C. Platt, "Probabilistic outputs for support vector machines", 1999; G. W. Brier, 1950.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from experiments.verdicts.rates import Rate
from experiments.verdicts.scoring import score_all

EDGES = (0.0, 0.3, 0.5, 0.7, 0.9, 1.0)
STEPS = 100


def collect(cases: Path, verdicts: Path, *, classes: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Claimed probabilities (n,) of all findings, and whether each is right (n,); of their classes where these are asked for."""
    findings = [f for scored in score_all(cases, verdicts) for f in scored.findings]
    told = [(f.class_probability, f.class_right) if classes else (f.probability, f.right) for f in findings]
    return np.array([p for p, _ in told], dtype=float), np.array([right for _, right in told], dtype=float)


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


def draw(rows: Sequence[tuple[str, list[dict[str, float]]]], file: Path) -> None:
    """The reliability diagram: claimed against observed, areas by the number of findings."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5.2, 5.0), layout="constrained")
    axes.plot([0, 1], [0, 1], color="0.7", lw=1)
    looks = (
        ("tab:blue", (6, -12)),
        ("tab:orange", (-18, -12)),
    )  # labels on either side, as points of both series fall together
    for (label, bins), (colour, beside) in zip(rows, looks[: len(rows)], strict=True):
        claimed, right = [b["claimed"] for b in bins], [b["right"] for b in bins]
        axes.plot(claimed, right, color=colour, lw=1, label=label)
        axes.scatter(claimed, right, s=[12 + 6 * b["findings"] for b in bins], color=colour, alpha=0.7)
        for b in bins:
            axes.annotate(
                f"{b['findings']:.0f}", (b["claimed"], b["right"]), beside, textcoords="offset points", color=colour
            )
    axes.set(
        xlim=(0, 1.03), ylim=(-0.03, 1.06), xlabel="probability claimed", ylabel="share of findings that are right"
    )
    axes.legend(loc="upper left", frameon=False)
    figure.savefig(file, dpi=150)
    pyplot.close(figure)


def _logit(p: np.ndarray) -> np.ndarray:
    bounded = np.clip(p, 1e-3, 1 - 1e-3)
    return np.log(bounded / (1 - bounded))


def scored(out: Path, folders: Sequence[Path], *, classes: bool) -> dict[str, Any]:
    """What is claimed against what is right, fitted on the first pair of folders, and the diagram."""
    claimed, right = collect(*folders[:2], classes=classes)
    if len(folders) > 2:
        fit_on, test_on = (claimed, right), collect(*folders[2:4], classes=classes)
    else:
        fit_on, test_on = (claimed[::2], right[::2]), (claimed[1::2], right[1::2])
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
    out.mkdir(parents=True, exist_ok=True)
    tested = (("as claimed", reliability(*test_on)), ("mapped", reliability(mapped(test_on[0], weights), test_on[1])))
    draw(tested, out / ("classes.png" if classes else "reliability.png"))
    return result


def main(out: Path, folders: Sequence[Path]) -> None:
    result = scored(out, folders, classes=False) | {"classes": scored(out, folders, classes=True)}
    (out / "calibration.json").write_text(json.dumps(result, indent=1) + "\n")
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    if len(sys.argv) not in (4, 6):
        sys.exit(__doc__)
    main(Path(sys.argv[1]), [Path(a) for a in sys.argv[2:]])
