"""Ambiguous cases, the recording that each asks for, and what it decides: `python -m experiments.resolving --out results/resolving`.

    python -m experiments.resolving --cases 30 --seed 1 --out DIR --page docs/validation/design.md

Draws cases on four small machines until so many verdicts are open (a class, or less sure than 0.9), designs a recording for each, runs
the machine (code that shares nothing with the tool) with it, and diagnoses again; beside it with a random multisine of the same power.
A process for each case; interrupted, the same command goes on where it was. With --cases 0 only the page is written, of what there is.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from pathlib import Path
from typing import Any

from experiments.resolving.loop import OUTCOME, run_case
from experiments.resolving.page import write_page

MOST_DRAWN = 5
"""Times the cases wanted that are drawn at most."""


def main(arguments: list[str] | None = None) -> int:
    """0 where enough cases were open; 1 where there were fewer."""
    chosen = _parsed(arguments)
    opened, number = 0, 0
    while opened < chosen.cases and number < MOST_DRAWN * chosen.cases:
        outcome = _outcome(chosen.out / f"c{number:03d}", chosen.seed, number, chosen.limit)
        opened += bool(outcome.get("open"))
        _tell(f"c{number:03d} {outcome.get('question', '')}: {_said(outcome)}")
        number += 1
    if chosen.page is not None:
        write_page(
            chosen.out, chosen.page, f"python -m experiments.resolving --cases {chosen.cases} --seed {chosen.seed}"
        )
    return 0 if opened >= chosen.cases else 1


def _outcome(folder: Path, seed: int, number: int, limit: float) -> dict[str, Any]:
    """That of an earlier run, or of a process of its own; a failure is an outcome too."""
    file = folder / OUTCOME
    if not file.is_file():
        began = time.perf_counter()
        process = multiprocessing.get_context("spawn").Process(target=run_case, args=(folder, seed, number))
        process.start()
        process.join(limit)
        if process.is_alive():
            process.terminate()
            process.join()
        if not file.is_file():
            _tell(f"c{number:03d}: no outcome after {time.perf_counter() - began:.0f} s (exit {process.exitcode})")
            return {"failed": True}
    return json.loads(file.read_text(encoding="utf-8"))


def _opened(out: Path) -> int:
    """How many of the cases that lie in a folder were open."""
    return sum(json.loads(file.read_text(encoding="utf-8"))["open"] for file in out.glob(f"*/{OUTCOME}"))


def _said(outcome: dict[str, Any]) -> str:
    if not outcome.get("open"):
        return outcome.get("said", "failed")
    if "refused" in outcome:
        return f"no design: {outcome['refused']}"
    return (
        f"{outcome['effect']}: {outcome['before']:.2f} -> {outcome['designed']['probability']:.2f} "
        f"(expected {outcome['expected']:.2f}; at random {outcome['random']['probability']:.2f}), "
        f"{outcome['design_seconds']:.1f} s"
    )


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m experiments.resolving", description=str(__doc__).split("\n", 1)[0])
    parser.add_argument("--cases", type=int, default=30, help="open verdicts wanted")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=400.0, help="seconds after which a case is given up")
    parser.add_argument("--out", type=Path, default=Path("results/resolving"))
    parser.add_argument("--page", type=Path, help="a page in Markdown, its figure beside it")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
