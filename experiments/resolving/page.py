"""What was measured, as a page: totals, by question, case by case, and a figure of predicted against realised evidence."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from experiments.resolving.judging import SURE
from experiments.resolving.loop import OUTCOME
from experiments.speed.settings import header
from experiments.verdicts.rates import Rate

Outcome = Mapping[str, Any]
FIGURE = "design.png"
LEAST_NATS = 3.0
"""Predicted evidence from which it is compared with what was realised: below, errors alone make a factor of two."""
FACTOR = 2.0


def write_page(out: Path, page: Path, command: str) -> None:
    """The page from what lies in a folder, with its figure beside it."""
    outcomes = [json.loads(f.read_text(encoding="utf-8")) for f in sorted(out.glob(f"*/{OUTCOME}"))]
    page.parent.mkdir(parents=True, exist_ok=True)
    draw(outcomes, page.with_name(FIGURE))
    page.write_text(text(outcomes, command, header()), encoding="utf-8")


def is_counted(outcome: Outcome) -> bool:
    """Whether something was open that the design says an input decides, as the verdict had it."""
    return bool(outcome["open"]) and outcome.get("leading", 1.0) < SURE


def text(outcomes: Sequence[Outcome], command: str, about: Mapping[str, str]) -> str:
    """The page in Markdown."""
    opened = [o for o in outcomes if o["open"]]
    counted = [o for o in opened if is_counted(o)]
    compared = [o for o in opened if o.get("predicted_nats", 0.0) >= LEAST_NATS]
    designed = [o for o in opened if "design_seconds" in o]
    seconds = [o["design_seconds"] for o in designed]
    close = sum(1 / FACTOR <= max(o["realised_nats"], 0.0) / o["predicted_nats"] <= FACTOR for o in compared)
    rows = [
        ("cases drawn; verdicts left open", f"{len(outcomes)}; {len(opened)}"),
        ("of them without a design, and why", _refused(opened)),
        ("of them nothing that an input decides is open, as the design says", str(len(designed) - len(counted))),
        (
            "verdicts among these that were wrong: the right answer below 0.1",
            str(sum(_wrong_before(o) for o in designed)),
        ),
        ("left to decide", str(len(counted))),
        (f"**decided rightly at {SURE:g} or more, with the designed recording**", str(_right(counted, "designed"))),
        ("the same with a random multisine of the same power", str(_right(counted, "random"))),
        ("sure of a wrong answer: designed, random", f"{_wrong(counted, 'designed')}, {_wrong(counted, 'random')}"),
        ("realised evidence within a factor of two of the predicted", str(Rate(close, len(compared)))),
        (
            "limits left: in simulation under any hypothesis, on the machine",
            ", ".join(str(sum(not o[k] for o in designed)) for k in ("limits_kept_in_simulation", "limits_kept")),
        ),
        ("seconds of a design on the clock: median, largest", _middle(seconds)),
        (
            "processor seconds of it, the compiler's not counted: median, largest",
            _middle([o["design_processor"] for o in designed]),
        ),
    ]
    machine = f"{about['processor']}, {about['cores']} cores, shared with other work"
    head = f"`{command}`\n\nCommit {about['commit']}, {about['date']}, {machine}."
    return "\n\n".join(
        [
            "# A recording that decides",
            "Small machines whose first recordings leave a question open: one direction only, slow, small. `greybox diagnose` says what\n"
            "cannot be told apart, [`greybox design`](../howto/design.md) asks for a recording, the machine (code that shares nothing\n"
            "with the tool) is run with it, open loop, from where its first recording began, for as long; and old and new recordings are\n"
            "diagnosed together. Beside it the same with a random multisine of the same mean square over all frequencies that a design\n"
            "may use, raised for what the input's limits cut off; its phases are drawn until the machine keeps its limits; only where ten\n"
            "draws do not it is made smaller. It is drawn knowing the machine; the design knows the hypotheses alone.",
            head,
            _table(("measured", "found"), rows),
            "An answer is right where it names what is concealed, or what the design says no input within the limits tells from it. "
            "Hypotheses that are one and the same for a machine (an offset of the drive, a constant force) are not counted as open.",
            _table(("question", "left to decide", "designed", "random"), _by_question(counted)),
            f"![predicted against realised evidence]({FIGURE})",
            "Evidence is the log-likelihood ratio between the right hypothesis and the rival that is expected to come nearest: predicted\n"
            "by the design, realised by estimating both without the new recording and with it. Of predictions below "
            f"{LEAST_NATS:g} nats nothing\nis compared, as errors alone make a factor of two there.",
            _table(
                ("case", "question", "concealed", "right before", "expected", "designed", "random", "nats predicted", "realised", "s"),
                [_row(o) for o in opened],
            ),
        ]
    ) + "\n"  # fmt: skip


def draw(outcomes: Sequence[Outcome], file: Path) -> None:
    """Realised over predicted evidence, on logarithmic scales, with the band of a factor of two."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.6, 4.6), layout="constrained")
    axes = figure.subplots()
    shown = [o for o in outcomes if o.get("predicted_nats", 0.0) > 0]
    for name in dict.fromkeys(o["question"] for o in shown):
        own = [o for o in shown if o["question"] == name]
        # What is below a tenth of a nat, noise having turned it about, stands at the lower edge.
        axes.scatter(
            [o["predicted_nats"] for o in own], [max(o["realised_nats"], 0.1) for o in own], label=name, s=22, alpha=0.8
        )
    ends = np.array([0.1, 2.0 * max([10.0, *(max(o["predicted_nats"], o["realised_nats"]) for o in shown)])])
    axes.plot(ends, ends, color="0.5", lw=1)
    axes.fill_between(ends, ends / FACTOR, ends * FACTOR, color="0.9", zorder=0)
    axes.axvline(LEAST_NATS, color="0.8", lw=1, ls="--")
    axes.set(xscale="log", yscale="log", xlabel="evidence predicted [nats]", ylabel="evidence realised [nats]")
    if shown:
        axes.legend(fontsize="small", frameon=False)
    figure.savefig(file, dpi=130)


def _wrong_before(outcome: Outcome) -> bool:
    return not is_counted(outcome) and outcome["before"] <= 1.0 - SURE


def _middle(values: Sequence[float]) -> str:
    return f"{median(values):.1f}, {max(values):.1f}" if values else "none"


def _right(counted: Sequence[Outcome], name: str) -> Rate:
    return Rate(sum(o[name]["probability"] >= SURE for o in counted), len(counted))


def _wrong(counted: Sequence[Outcome], name: str) -> int:
    return sum(not o[name]["open"] and o[name]["probability"] <= 1.0 - SURE for o in counted)


def _refused(opened: Sequence[Outcome]) -> str:
    reasons = [o["refused"] for o in opened if "refused" in o]
    return "; ".join(f"{reasons.count(r)} ({r})" for r in dict.fromkeys(reasons)) or "0"


def _by_question(counted: Sequence[Outcome]) -> list[tuple[str, ...]]:
    rows = []
    for name in dict.fromkeys(o["question"] for o in counted):
        own = [o for o in counted if o["question"] == name]
        right = [str(sum(o[k]["probability"] >= SURE for o in own)) for k in ("designed", "random")]
        rows.append((name, str(len(own)), *right))
    return rows


def _row(o: Outcome) -> tuple[str, ...]:
    first = (f"{o['number']}", o["question"], o["effect"], f"{o['before']:.2f}")
    if "refused" in o:
        return (*first, *["-"] * 6)
    expected = f"{o['expected']:.2f}" if is_counted(o) else "nothing to decide"
    nats = [f"{o[k]:.3g}" if k in o else "-" for k in ("predicted_nats", "realised_nats")]
    ends = (f"{o['designed']['probability']:.2f}", f"{o['random']['probability']:.2f}")
    return (*first, expected, *ends, *nats, f"{o['design_processor']:.1f}")


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
