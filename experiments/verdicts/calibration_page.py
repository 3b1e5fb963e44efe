"""Whether probabilities mean what they say, as a figure and a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.verdicts.answers import half_brier
from experiments.verdicts.calibrate import EDGES
from experiments.verdicts.rates import Rate
from experiments.verdicts.scoring import Finding, Scored
from experiments.verdicts.totals import brier_of, brier_of_answers, brier_of_classes, brier_of_exact_names

Bins = Sequence[Mapping[str, float]]
ENOUGH = 20
"""Claims from which a bin is judged."""
MOST = 12
"""Findings that are listed, those that cost most."""
FIGURE = "calibration.png"
WANTED = {"names": 0.05, "exact names": None, "answers": 0.05, "classes": 0.02}
"""Brier scores to keep. Of exact names there is none: what no recording can tell apart costs a quarter, however rightly it is shared."""


def draw(panels: Sequence[tuple[str, Bins]], file: Path) -> None:
    """Reliability diagrams beside each other: what came true of what was claimed, with exact intervals of 95 %, and how many each."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(3.6 * len(panels), 3.9), layout="constrained")
    for axes, (title, bins) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        axes.plot([0, 1], [0, 1], color="0.7", lw=1)
        for row in bins:
            colour = "tab:blue" if row["findings"] >= ENOUGH else "0.6"
            axes.plot([row["claimed"]] * 2, [row["lower"], row["upper"]], color=colour, lw=2, alpha=0.6)
            axes.plot(row["claimed"], row["right"], "o", color=colour)
            above = row["claimed"] < 0.5
            axes.annotate(
                f"{row['findings']:.0f}",
                (row["claimed"], row["upper"] if above else row["lower"]),
                (0, 3 if above else -11),
                textcoords="offset points",
                ha="center",
                fontsize="small",
                color=colour,
            )
        axes.set(xlim=(0, 1.03), ylim=(-0.08, 1.1), title=title, xlabel="probability claimed")
    figure.axes[0].set_ylabel("share that came true")
    figure.savefig(file, dpi=130)


def panels_of(result: Mapping[str, Any]) -> list[tuple[str, Bins]]:
    """Those of what was tested, from the result of a calibration."""
    return [(what, result[what]["tested on"]["reliability"]) for what in WANTED]


def write_page(page: Path, result: Mapping[str, Any], scored: Sequence[Scored], about: str) -> None:
    """The page, with its figure beside it."""
    page.parent.mkdir(parents=True, exist_ok=True)
    draw(panels_of(result), page.with_name(FIGURE))
    page.write_text(text(result, scored, about), encoding="utf-8")


def text(result: Mapping[str, Any], scored: Sequence[Scored], about: str) -> str:
    """Scores, bins and the costliest findings, in Markdown.

    Args:
        result: of a calibration, whose tested set are the findings of ``scored``.
        about: which verdicts these are, in a sentence or two.
    """
    findings = [f for s in scored for f in s.findings]
    of = (brier_of, brier_of_exact_names, brier_of_answers, brier_of_classes)
    scores = ((what, score(findings)) for what, score in zip(WANTED, of, strict=True))
    rows = [(what, f"{score:.3f}", _wanted(what), _by_a_map(result[what])) for what, score in scores]
    bins = [line for what in WANTED for line in _bins(what, result[what]["tested on"]["reliability"])]
    elsewhere = f"by a map fitted on {result['names']['fitted on']['findings']} other findings"
    return "\n\n".join(
        [
            "# Do the probabilities mean what they say?",
            *([about] if about else []),
            f"{len(findings)} findings of {len(scored)} cases. *Names*: the name that a finding is told as, right where the key accepts\n"
            "it. *Exact names*: right where it is what was concealed itself, and no look-alike that no recording tells from it: of two\n"
            "such names told with 0.48 each, one in two should be. *Answers*: names that the key accepts are one answer, whose\n"
            "probability is their sum, and what is claimed of wrong answers counts too (half of Brier's sum of squares). *Classes*:\n"
            "the whole statement, right where one of its members is.",
            _table(("of", "Brier", "wanted", f"a claim: as it is, {elsewhere}"), rows),
            f"![What came true of what was claimed, with intervals of 95 %; grey: fewer than {ENOUGH} claims]({FIGURE})",
            _table(("of", "claimed between", "claims", "claimed on average", "came true (95 %)", "judged"), bins),
            "What costs most, and each finding's part of the three scores:",
            _table(("case", "concealed", "said", "probability", "name", "answer", "class"), _costliest(scored)),
        ]
    ) + "\n"  # fmt: skip


def _wanted(what: str) -> str:
    return "" if WANTED[what] is None else f"{WANTED[what]:g}"


def _by_a_map(found: Mapping[str, Any]) -> str:
    told = found["tested on"]
    return f"{told['brier']:.3f}, {told['brier mapped']:.3f}"


def _bins(what: str, bins: Bins) -> list[tuple[str, ...]]:
    lines = []
    for row in bins:
        low = max(e for e in EDGES if e < row["claimed"])
        high = min(e for e in EDGES if e >= row["claimed"])
        count = int(row["findings"])
        within = row["lower"] <= row["claimed"] <= row["upper"]
        judged = "fewer than 20" if count < ENOUGH else "within" if within else "**outside**"
        share = str(Rate(round(row["right"] * count), count))
        lines.append((what, f"{low:g} and {high:g}", str(count), f"{row['claimed']:.3f}", share, judged))
    return lines


def _costliest(scored: Sequence[Scored]) -> list[tuple[str, ...]]:
    told = [(s, f, _costs(f)) for s in scored for f in s.findings]
    told.sort(key=lambda one: -max(one[2]))
    return [
        (
            s.name,
            ", ".join(s.effects) or "nothing",
            f"{f.mechanism} at {f.port}",
            f"{f.probability:.2f}, class {f.class_probability:.2f}",
            *(f"{cost / len(told):.4f}" for cost in costs),
        )
        for s, f, costs in told[:MOST]
    ]


def _costs(f: Finding) -> tuple[float, float, float]:
    return (f.probability - f.right) ** 2, half_brier(f.answers), (f.class_probability - f.class_right) ** 2


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
