"""`greybox fleet` in a process of its own, watched from outside: what is done, which processes there are, what they take."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

ROW = "fleet_row.json"
POLL = 0.5
_ALONE = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")


class FleetFailed(Exception):
    """The command came to no result."""


@dataclass(frozen=True)
class Ran:
    """A run that was not killed: its ``result`` as --json prints it; ``seconds`` of the clock, ``processor`` seconds of it and all that it
    started; ``worker_memory`` and ``own_memory``, the most that a worker and the command itself held, in MiB.
    """

    result: dict[str, Any]
    seconds: float
    processor: float
    worker_memory: float
    own_memory: float


class Fleet:
    """The command under way on the cards below ``root``, with results in ``out``; it is killed where the block is left early."""

    def __init__(self, root: Path, out: Path, workers: int) -> None:
        self.out = out
        self._began = time.perf_counter()
        self._memory = {"worker": 0.0, "own": 0.0}
        arguments = ["fleet", str(root), "--out", str(out), "--workers", str(workers), "--json"]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "greybox_torch", *arguments],
            env={**os.environ, **_ALONE},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def __enter__(self) -> Fleet:
        return self

    def __exit__(self, *about: object) -> None:
        if self._process.poll() is None:
            self.kill()

    def workers(self) -> list[psutil.Process]:
        """The worker processes that there are now."""
        found = []
        for child in psutil.Process(self._process.pid).children():
            try:
                if any("spawn_main" in word for word in child.cmdline()):
                    found.append(child)
            except psutil.Error:
                continue
        return found

    def wait_until(self, enough: Callable[[], bool]) -> None:
        """Raises FleetFailed where the command ends before."""
        while not enough():
            if self._process.poll() is not None:
                raise FleetFailed(f"greybox fleet ended before, with exit code {self._process.returncode}")
            self._look()
            time.sleep(POLL)

    def kill_a_worker(self) -> None:
        self.workers()[0].kill()

    def kill(self) -> None:
        """The command itself, without a chance to end its workers: they see that it is gone."""
        workers = self.workers()
        self._process.send_signal(signal.SIGKILL)
        self._process.communicate()
        _, alive = psutil.wait_procs(workers, timeout=30.0)
        for worker in alive:
            worker.kill()

    def finish(self) -> Ran:
        """Its result. Raises FleetFailed."""
        before = _processor_of_children()
        out, _ = self._read_to_the_end()
        if self._process.returncode != 0:
            raise FleetFailed(f"greybox fleet: exit code {self._process.returncode}")
        seconds = time.perf_counter() - self._began
        memory = self._memory
        spent = _processor_of_children() - before
        return Ran(json.loads(out), seconds, spent, memory["worker"], memory["own"])

    def _read_to_the_end(self) -> tuple[str, None]:
        while True:
            try:
                out, _ = self._process.communicate(timeout=POLL)
                return out, None
            except subprocess.TimeoutExpired:
                self._look()

    def _look(self) -> None:
        try:
            own, workers = psutil.Process(self._process.pid), self.workers()
            sizes = {"own": [own], "worker": workers}
            for name, processes in sizes.items():
                largest = max((p.memory_info().rss / 2**20 for p in processes), default=0.0)
                self._memory[name] = max(self._memory[name], largest)
        except psutil.Error:
            return


def done_rows(out: Path) -> dict[Path, int]:
    """When every data set that is done was written, in ns, by the file of its row."""
    return {path: path.stat().st_mtime_ns for path in sorted(out.rglob(ROW))}


def diagnosed_alone(card: Path, out: Path) -> tuple[dict[str, Any], Mapping[str, float]]:
    """The verdict of `greybox diagnose` in a process of its own, and what it took: seconds, processor seconds, MiB."""
    began = time.perf_counter()
    arguments = ["diagnose", str(card), "--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-m", "greybox_torch", *arguments],
        env={**os.environ, **_ALONE},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise FleetFailed(f"greybox diagnose {card}: exit code {process.returncode}")
    taken = {
        "seconds": time.perf_counter() - began,
        "processor": used.ru_utime + used.ru_stime,
        "memory": used.ru_maxrss / 1024,
    }
    return json.loads((out / "verdict.json").read_text()), taken


def _processor_of_children() -> float:
    used = os.times()
    return used.children_user + used.children_system
