"""Processes killed while they write, two that compile at once, and disks without room; whole commands: `python -m experiments.kills`."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from greybox_torch import cli
from greybox_torch.__main__ import main
from greybox_torch.codegen import build
from greybox_torch.errors import UserError
from greybox_torch.files import json_text, write_all, write_text

WRITES = """
import signal
import sys
from pathlib import Path
from greybox_torch.files import json_text, write_all

signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background of a shell
folder, size = Path(sys.argv[1]), int(sys.argv[2])
print("begun", flush=True)
for k in range(10**9):
    write_all({folder / f"{name}.json": json_text({"run": k, "text": "x" * size}) for name in "abc"})
"""
COMPILES = """
import sys
from greybox_torch.codegen.build import TRIAL, library

sys.exit(library(TRIAL).works() != 1)
"""


@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_what_is_written_is_whole(tmp_path: Path, sent: signal.Signals) -> None:
    """Files that are replaced all the time by a process that is killed."""
    rng = np.random.default_rng(sent)
    for k in range(2):
        arguments = [sys.executable, "-c", WRITES, str(tmp_path / "out"), "300000"]
        process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert process.stdout is not None and process.stdout.readline() == b"begun\n"
        time.sleep(float(rng.uniform(0.0, 0.1)))
        process.send_signal(sent)
        try:
            process.communicate(timeout=30)
        finally:
            process.kill()
        for file in (tmp_path / "out").glob("[!.]*"):
            assert len(json.loads(file.read_text())["text"]) == 300000, k


@pytest.mark.skipif(build.compiler() is None, reason="no C++ compiler")
def test_two_processes_with_a_cold_cache(tmp_path: Path) -> None:
    environment = {**os.environ, "GREYBOX_CACHE": str(tmp_path / "cache")}
    both = [subprocess.Popen([sys.executable, "-c", COMPILES], env=environment) for _ in range(2)]
    assert [process.wait(60) for process in both] == [0, 0]
    assert [file.suffix for file in (tmp_path / "cache").iterdir()] == [".so"]


def test_a_full_disk(tmp_path: Path) -> None:
    """No file may be larger than 10 kB: what was there stays, nothing else is left, and the message says why."""
    write_text(tmp_path / "a.json", json_text({"run": 1}))
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, before[1]))
    try:
        with pytest.raises(UserError, match=r"b\.json: cannot be written: File too large; expected a place"):
            write_all({tmp_path / "a.json": json_text({"run": 2}), tmp_path / "b.json": "x" * 100_000})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [file.name for file in tmp_path.iterdir()] == ["a.json"]
    assert json.loads((tmp_path / "a.json").read_text()) == {"run": 1}


def test_ctrl_c_while_loading(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Seen: a traceback out of an import, half a second after the start."""

    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "main", interrupted)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 130 and capsys.readouterr().err == "interrupted\n"
