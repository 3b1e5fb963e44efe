"""One diagnosis by one tree, in a process of its own, twice: with nothing in the cache of machine code, and with all that it needs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from experiments.speed.settings import CHECKOUT

LIMIT = 900
"""Seconds that a case has."""


@dataclass(frozen=True)
class Timed:
    """Seconds of a diagnosis with cached machine code and without, its stages and passes in the former, and what it said.

    ``leading``: after how many seconds a finding of the verdict stood on the screen, and one did from then on (see :func:`stood_from`).
    """

    seconds: float
    cold: float
    stages: dict[str, float]
    passes: dict[str, dict[str, float]]
    said: str
    leading: float = float("inf")

    def as_json(self) -> dict[str, Any]:
        return asdict(self)

    @property
    def largest(self) -> str:
        """The three purposes whose passes take longest, in words."""
        seconds = {name: amounts["seconds"] for name, amounts in self.passes.items()}
        first = sorted(seconds, key=lambda name: -seconds[name])[:3]
        return ", ".join(f"{name} {seconds[name]:.1f} s" for name in first)


def timed(tree: Path, card: Path, time_limit: float | None = None) -> Timed | None:
    """The diagnosis of ``card`` by the package in the folder ``tree``; None where it did not end in time or failed."""
    with tempfile.TemporaryDirectory() as folder:
        results = [
            _run(tree, card, Path(folder) / name, Path(folder) / "cache", time_limit) for name in ("cold", "warm")
        ]
    cold, warm = results
    if cold is None or warm is None:
        return None
    verdict, took = warm
    effects = [f"{e['port']} {e['mechanism']}" for e in verdict["effects"]]
    said = ", ".join(effects) or ("missing, no name" if verdict["mismatch"] else "nothing")
    leading = stood_from(took.get("heard", []), verdict, took["seconds"])
    return Timed(verdict["seconds"], cold[0]["seconds"], verdict["stages"], took["passes"], said, leading)


def stood_from(
    heard: Sequence[tuple[float, Sequence[Sequence[str]]]], verdict: Mapping[str, Any], whole: float
) -> float:
    """After how many seconds one of a verdict's findings, or what it cannot be told from, led on the screen and did so to the end.

    Args:
        heard: after how many seconds which effects led.
        whole: seconds of the whole diagnosis, where nothing was found or nothing of it was told.
    """
    told = {(e["port"], e["mechanism"]) for e in verdict["effects"]}
    told |= {
        (m["port"], m["mechanism"]) for e in verdict["effects"] for m in (e.get("one_of") or {}).get("members", ())
    }
    since = whole
    for seconds, effects in reversed(heard):
        if effects and not told & {(port, mechanism) for port, mechanism in effects}:
            break
        since = seconds if effects else since
    return since


def _run(
    tree: Path, card: Path, out: Path, cache: Path, time_limit: float | None
) -> tuple[dict[str, Any], dict[str, Any]] | None:
    environment = {**os.environ, "PYTHONPATH": str(tree), "GREYBOX_CACHE": str(cache)}
    command = [sys.executable, str(Path(__file__).with_name("profiled.py")), str(card), str(out)]
    command += [] if time_limit is None else ["--time-limit", f"{time_limit:g}"]
    try:
        done = subprocess.run(
            command,
            cwd=tree,
            env=environment,
            timeout=LIMIT,
            check=False,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        return None
    if done.returncode != 0:
        return None
    return json.loads((out / "verdict.json").read_text()), json.loads((out / "passes.json").read_text())


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """The tree of another commit of this repository, for as long as it is needed.

    Raises:
        ValueError: there is no such commit.
    """
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        git = ["git", "-C", str(CHECKOUT), "worktree"]
        done = subprocess.run(
            [*git, "add", "--detach", "--quiet", str(tree), commit], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            raise ValueError(f"--against {commit}: {done.stderr.strip()}")
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], capture_output=True, check=False)
