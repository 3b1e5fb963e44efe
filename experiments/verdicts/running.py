"""`greybox diagnose` on many cases, as a user would: a few side by side, which share the cores. Keys are never read.

Resumable: an attempt writes into a folder of its own, which becomes the verdict's when it is whole; what has a verdict is passed over.
"""

from __future__ import annotations

import json
import os
import secrets
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from greybox_torch.cores import allowed_cores
from greybox_torch.files import json_text, write_text

ROOT = Path(__file__).parents[2]
VERDICT, RUN = "verdict.json", "run.json"
GRACE = 3.0
"""Times the time limit (and a minute) after which a case is given up: the limit stops the tool's search, not what comes after it."""
NO_LIMIT = 3600.0
"""Seconds after which a case without a time limit is given up."""


@dataclass(frozen=True)
class Outcome:
    """What came of one case: the seconds it took, what was said in a few words, and why there is no verdict (empty where there is one)."""

    seconds: float
    said: str
    failure: str = ""


def diagnose_all(
    cards: Mapping[str, Path],
    out: Path,
    *,
    workers: int,
    time_limit: float | None,
    tell: Callable[[str, Outcome], None],
) -> None:
    """Diagnose the cards, `workers` cases side by side, into OUT/NAME. `tell` hears of each as it ends, one at a time.

    Where `tell` fails, or the user interrupts, cases that have not begun are left for the next time.
    """
    for abandoned in out.glob(".*.attempt"):  # of a run that was killed
        shutil.rmtree(abandoned, ignore_errors=True)
    lock = threading.Lock()

    def one(name: str) -> None:
        outcome = diagnose(cards[name], out / name, time_limit, threads=max(1, allowed_cores() // workers))
        with lock:
            tell(name, outcome)

    pool = ThreadPoolExecutor(workers)
    try:
        for done in [pool.submit(one, name) for name in cards]:
            done.result()
    finally:
        pool.shutdown(cancel_futures=True)


def diagnose(card: Path, out: Path, time_limit: float | None, *, threads: int | None = None) -> Outcome:
    """One case by the command line: OUT holds what it wrote and run.json, or run.json alone where it ended without a verdict.

    `threads` is how many the tool may use; None leaves that to the tool.
    """
    # A folder for each attempt: a tool that outlived a killed run cannot touch what comes later.
    attempt = out.with_name(f".{out.name}.{secrets.token_hex(4)}.attempt")
    command = [sys.executable, "-m", "greybox_torch", "diagnose", str(card), "--out", str(attempt), "--json"]
    command += [] if time_limit is None else ["--time-limit", f"{time_limit:g}"]
    allowed = NO_LIMIT if time_limit is None else GRACE * time_limit + 60.0
    path = os.pathsep.join(part for part in (str(ROOT), os.environ.get("PYTHONPATH", "")) if part)
    within = {**os.environ, "PYTHONPATH": path} | ({} if threads is None else {"OMP_NUM_THREADS": str(threads)})
    began = time.perf_counter()
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=allowed, env=within)
        failure = "" if done.returncode == 0 else f"exit {done.returncode}: {_last_line(done.stderr)}"
    except subprocess.TimeoutExpired:
        failure = f"no verdict after {allowed:.0f} s"
    seconds = round(time.perf_counter() - began, 1)
    if not failure and not (attempt / VERDICT).is_file():
        failure = f"no {VERDICT} was written"
    if failure:
        shutil.rmtree(attempt, ignore_errors=True)
        outcome = Outcome(seconds, failure, failure)
    else:
        outcome = Outcome(seconds, sentence(json.loads((attempt / VERDICT).read_text(encoding="utf-8"))))
    write_text(attempt / RUN, json_text({"seconds": seconds, "said": outcome.said, "failure": failure}))
    shutil.rmtree(out, ignore_errors=True)  # of an earlier attempt without a verdict
    attempt.rename(out)
    return outcome


def has_verdict(out: Path) -> bool:
    return (out / VERDICT).is_file()


def sentence(verdict: Mapping[str, Any]) -> str:
    """What a verdict says, in a few words."""
    if verdict["effects"]:
        return ", ".join(f"{e['mechanism']} at {e['port']} ({e['probability']:.2f})" for e in verdict["effects"])
    if verdict["mismatch"]:
        return "something missing, without a name"
    return "no answer before the time limit" if verdict.get("complete") is False else "nothing missing"


def _last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
