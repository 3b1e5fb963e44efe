"""How many cores this process may use: fewer than the machine has, where it is bound to some or runs in a container."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

GROUPS, OWN_GROUP = Path("/sys/fs/cgroup"), Path("/proc/self/cgroup")
"""Where Linux tells of control groups, and of that of this process."""
OLDER = ("cpu", "cpu,cpuacct", "cpuacct,cpu")
"""Names of the folder that holds the limit of processor time in control groups of version 1."""


@lru_cache(maxsize=1)
def allowed_cores() -> int:
    """Those that the process is bound to, or as many as its container's share of processor time needs, where these are fewer.

    Asked once: the system takes as long to answer as a third of a short pass.
    """
    bound = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(bound, container_limit(GROUPS, OWN_GROUP) or bound)


def container_limit(groups: Path, own: Path) -> int | None:
    """Cores, a part of one counted as one, whose time the control groups of a process allow it; None where they set no limit.

    Args:
        groups: the folder of all control groups.
        own: the file that says which of them the process is in.
    """
    limits = [math.ceil(quota / period) for quota, period in _shares(groups, own) if quota > 0 and period > 0]
    return min(limits, default=None)


def _shares(groups: Path, own: Path) -> Iterator[tuple[int, int]]:
    """Microseconds of processor time in so many of the clock: of version 1, and of version 2 those of every group around the process."""
    for name in OLDER:
        yield _numbers(_text(groups / name / "cpu.cfs_quota_us") + " " + _text(groups / name / "cpu.cfs_period_us"))
    for line in _text(own).splitlines():
        if line.startswith("0::"):
            inner = groups / line[3:].strip().lstrip("/")
            for folder in (inner, *inner.parents):
                if folder.is_relative_to(groups):
                    yield _numbers(_text(folder / "cpu.max"))


def _numbers(text: str) -> tuple[int, int]:
    """The two numbers of ``text``; zeros where it says "max" or less than two."""
    try:
        quota, period = map(int, text.split())
    except ValueError:
        return 0, 0
    return quota, period


def _text(path: Path) -> str:
    try:
        return path.read_text()
    except (OSError, ValueError):  # no such limit on this system
        return ""
