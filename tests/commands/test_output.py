"""Standard output that is full, or closed by its reader: no traceback, and the results are in their files."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

NEW = [sys.executable, "-m", "greybox_torch", "new", "drive"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("json", [[], ["--json"]])
def test_full(tmp_path: Path, json: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*NEW, *json], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr.strip().splitlines()[-1] == "error: standard output: cannot be written: No space left on device"
    assert (tmp_path / "drive.py").exists()


def test_closed_by_its_reader(tmp_path: Path) -> None:
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(NEW, cwd=tmp_path, stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "drive.py").exists()
