"""What the command line asks for, and the machine that it is measured on."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import subprocess
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

CORES = 2
"""Cores that every rival is measured on."""

PEERS = {"jax": "jax", "optimistix": "optimistix", "numba": "numba"}
"""Modules of the extra `[peers]` that rows may need."""

LIBRARIES = (
    "torch",
    "torchdiffeq",
    "numpy",
    "scipy",
    "jax",
    "jaxlib",
    "equinox",
    "lineax",
    "optimistix",
    "diffrax",
    "numba",
    "llvmlite",
)

CHECKOUT = Path(__file__).resolve().parents[2]
SHARED = CHECKOUT.parent / "shared"
PUBLISHED_CARD = SHARED / "recordings" / "robot_arm" / "dataset.toml"
ALL_FREE_CARD = CHECKOUT / "experiments" / "recordings" / "robot_arm_all_free.toml"


@dataclass(frozen=True)
class Settings:
    """``quick`` shrinks every measurement to what shows that it works; ``draws`` is the number of start values of the robustness row;
    ``against``, a commit that diagnoses are measured beside (none where empty); ``cases``, the names of those diagnosed (all where empty).
    """

    quick: bool = False
    draws: int = 40
    seed: int = 1
    against: str = ""
    cases: tuple[str, ...] = ()

    def repeats(self, count: int) -> int:
        return 5 if self.quick else max(count, 5)


def bind_to_cores() -> None:
    """Let this process and its children use the same two cores. To be called before numerical libraries are imported."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:CORES])
    for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[name] = str(CORES)


def missing_peers(needed: tuple[str, ...]) -> list[str]:
    """Those of ``needed`` that are not installed."""
    return [name for name in needed if version(PEERS.get(name, name)) is None]


def version(library: str) -> str | None:
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:
        return None


def header() -> dict[str, str]:
    """Versions of every library, the cores, the processor, the date and the commit, by name."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": _commit(),
        "processor": _processor(),
        "cores": f"{usable} used of {os.cpu_count()}",
        "number format": "float64",
        "compiler": _first_line([os.environ.get("CXX", "g++"), "--version"]),
        "python": platform.python_version(),
        "greybox_torch": version("greybox_torch") or "not installed",
    } | {name: version(name) or "not installed" for name in LIBRARIES}


def _commit() -> str:
    changed = _first_line(["git", "-C", str(CHECKOUT), "status", "--porcelain", "--untracked-files=no"])
    return _first_line(["git", "-C", str(CHECKOUT), "rev-parse", "--short", "HEAD"]) + (
        " with uncommitted changes" if changed not in ("", "unknown") else ""
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")
    family = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("cpu family")), "")
    return f"{model} (family {family})" if family else model


def _first_line(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return "unknown"
    if done.returncode != 0:
        return "unknown"
    return (done.stdout.splitlines() or [""])[0]
