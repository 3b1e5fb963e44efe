"""The tool on every sealed case, by command line as a user would, a few cases at a time; every verdict frozen as it comes.

Resumable, after a kill too: what is not on the record is diagnosed again, from nothing.
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
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from experiments.concealed.proof.files import sha256
from experiments.concealed.proof.record import Record

GRACE = 3.0
"""Times the time limit (and a minute) after which a case is given up: the limit stops the tool's search, not what comes after it."""


def diagnose_all(
    folder: Path, record: Record, *, workers: int, time_limit: float, progress: Callable[[str], None]
) -> None:
    """Diagnose what has no frozen verdict yet, `workers` cases side by side, each on one thread."""
    sealed = record.sealed or {"cases": {}}
    left = [name for name in sealed["cases"] if name not in record.verdicts]
    for abandoned in (folder / "verdicts").glob(".c*"):
        shutil.rmtree(abandoned, ignore_errors=True)
    lock, total = threading.Lock(), len(sealed["cases"])

    def one(name: str) -> None:
        entry = _diagnose(folder / "cases" / name, folder / "verdicts" / name, time_limit)
        with lock:
            record.add("verdict", case=name, **entry)
            progress(f"{len(record.verdicts)}/{total} {name} {entry['seconds']:.0f} s: {entry['said']}")

    pool = ThreadPoolExecutor(workers)
    try:
        for done in [pool.submit(one, name) for name in left]:
            done.result()
    finally:  # where one fails, or the user interrupts, what has not begun is left for the next time
        pool.shutdown(cancel_futures=True)


def _diagnose(case: Path, out: Path, time_limit: float) -> dict[str, Any]:
    """Run the tool; what goes on the record: the hash of the verdict (None where there is none), and what was said."""
    # Each attempt writes into a folder of its own: a tool that outlived a killed proof cannot touch what is frozen later.
    attempt = out.with_name(f".{out.name}.{secrets.token_hex(4)}")
    began = time.perf_counter()
    command = [sys.executable, "-m", "greybox_torch", "diagnose", str(case / "dataset.toml"), "--out", str(attempt)]
    command += ["--json", "--time-limit", f"{time_limit:g}"]
    allowed = GRACE * time_limit + 60.0
    try:
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            check=False,
            timeout=allowed,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        failure = "" if done.returncode == 0 else f"exit {done.returncode}: {_last_line(done.stderr)}"
    except subprocess.TimeoutExpired:
        failure = f"no verdict after {allowed:.0f} s"
    seconds = round(time.perf_counter() - began, 1)
    verdict = attempt / "verdict.json"
    shutil.rmtree(out, ignore_errors=True)  # of a run that was killed before its verdict was on the record
    if failure or not verdict.is_file():
        shutil.rmtree(attempt, ignore_errors=True)
        return {"sha256": None, "said": failure or "no verdict.json was written", "seconds": seconds}
    content = verdict.read_bytes()
    attempt.rename(out)
    return {"sha256": sha256(content), "said": sentence(json.loads(content)), "seconds": seconds}


def sentence(verdict: dict[str, Any]) -> str:
    """What a verdict says, in a few words."""
    if verdict["effects"]:
        return ", ".join(f"{e['mechanism']} at {e['port']} ({e['probability']:.2f})" for e in verdict["effects"])
    if verdict["mismatch"]:
        return "something missing, without a name"
    return "no answer before the time limit" if verdict.get("complete") is False else "nothing missing"


def _last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
