"""How many cores a process may use."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from greybox_torch.cores import allowed_cores, container_limit

BOUND = """
import os
os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:1])
from greybox_torch.simulation.side_by_side import cores
print(cores())
"""


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processes cannot be bound to cores here")
def test_a_process_that_is_bound_to_a_core_uses_that_one() -> None:
    """Seen: as many threads as the machine has cores, all of them on one."""
    free = {name: value for name, value in os.environ.items() if name != "OMP_NUM_THREADS"}
    done = subprocess.run([sys.executable, "-c", BOUND], env=free, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1"


def test_no_more_than_there_are() -> None:
    assert 1 <= allowed_cores() <= (os.cpu_count() or 1)


@pytest.mark.parametrize(
    ("files", "own", "expected"),
    [
        ({}, "", None),
        ({"cpu.max": "max 100000\n"}, "0::/\n", None),
        ({"cpu.max": "150000 100000\n"}, "0::/\n", 2),
        ({"cpu.max": "50000 100000\n"}, "0::/\n", 1),
        ({"pod/cpu.max": "300000 100000\n", "pod/one/cpu.max": "max 100000\n"}, "0::/pod/one\n", 3),
        ({"other/cpu.max": "100000 100000\n"}, "0::/pod\n", None),
        ({"cpu/cpu.cfs_quota_us": "250000\n", "cpu/cpu.cfs_period_us": "100000\n"}, "1:cpu:/\n0::/\n", 3),
        ({"cpu,cpuacct/cpu.cfs_quota_us": "-1\n", "cpu,cpuacct/cpu.cfs_period_us": "100000\n"}, "1:cpu:/\n", None),
    ],
)
def test_the_limit_of_a_container(tmp_path: Path, files: dict[str, str], own: str, expected: int | None) -> None:
    for name, content in files.items():
        (tmp_path / "groups" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "groups" / name).write_text(content)
    (tmp_path / "own").write_text(own)
    assert container_limit(tmp_path / "groups", tmp_path / "own") == expected
