"""Imports run one way, without circles: the contracts of pyproject.toml, checked by import-linter."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
LINT = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True, no_logo=True))"


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    """The contracts of the pyproject.toml in ``folder``, on the package of this checkout."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    command = [sys.executable, "-c", LINT]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_contracts_are_kept() -> None:
    done = lint(ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Contracts: 3 kept, 0 broken" in done.stdout


def test_contracts_notice_an_import_upwards_and_a_layer_that_is_not_listed(tmp_path: Path) -> None:
    """The same contracts with two layers exchanged and one taken out are broken, so they do look at this package."""
    text = (ROOT / "pyproject.toml").read_text()
    upside_down = re.sub(r'( *"estimate",\n)( *"simulation",\n)', r"\2\1", text)
    unlisted = text.replace('    "rates | checkpoint",\n', "")
    within = re.sub(r'( *"refit",\n)( *"screen \| hypothesis",\n)', r"\2\1", text)
    assert text not in (upside_down, unlisted, within)
    for changed, finding in (
        (upside_down, "greybox_torch.estimate is not allowed to import greybox_torch.simulation"),
        (unlisted, "greybox_torch.checkpoint"),
        (within, "greybox_torch.diagnosis.refit is not allowed to import greybox_torch.diagnosis.screen"),
    ):
        (tmp_path / "pyproject.toml").write_text(changed)
        done = lint(tmp_path)
        assert done.returncode == 1
        assert finding in done.stdout
