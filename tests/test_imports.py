"""Imports run one way, without circles: the contracts of pyproject.toml, checked by import-linter."""

from __future__ import annotations

import ast
import importlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXPERIMENTS = ROOT / "experiments"
MEASURES_THE_INSIDE = {
    ("speed/diagnosis/profiled.py", "greybox_torch.simulation.native"),
    ("speed/diagnosis/profiled.py", "greybox_torch.diagnosis.progress.Journal"),
}
"""It counts the calls of machine code, and hears what is told of the leading finding, of whichever commit is on the path."""
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


def is_public(module: str, name: str) -> bool:
    """Whether code outside of the package may import ``name`` from ``module``: one that exports it, or a file at the top of the package."""
    loaded = importlib.import_module(module)
    if hasattr(loaded, "__all__"):
        return name in loaded.__all__
    return (
        not hasattr(loaded, "__path__")
        and module.count(".") == 1
        and not name.startswith("_")
        and hasattr(loaded, name)
    )


def taken(text: str) -> Iterator[tuple[str, str]]:
    """What a program takes from the package, as pairs of a module and a name; the name is empty where the module is taken as a whole."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "greybox_torch":
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names if alias.name.startswith("greybox_torch."))


def test_experiments_take_only_what_is_public() -> None:
    deep = [
        f"{file}: {module}.{name}"
        for path in sorted(EXPERIMENTS.rglob("*.py"))
        for module, name in taken(path.read_text())
        if (file := path.relative_to(EXPERIMENTS).as_posix(), f"{module}.{name}") not in MEASURES_THE_INSIDE
        and not is_public(module, name)
    ]
    assert not deep


@pytest.mark.parametrize(
    ("text", "public"),
    [
        ("from greybox_torch import fit", True),
        ("from greybox_torch.errors import did_you_mean", True),
        ("from greybox_torch.diagnosis.screen import Screen", True),
        ("from greybox_torch.diagnosis.screen.score_test import Screen", False),
        ("from greybox_torch.diagnosis.screen import score_test", False),
        ("import greybox_torch.estimate.fit", False),
        ("def later():\n    from greybox_torch.api.fit import fit", False),
    ],
)
def test_what_is_public(text: str, public: bool) -> None:
    assert [is_public(*one) for one in taken(text)] == [public]


PACKAGES = sorted(".".join(p.parent.relative_to(ROOT).parts) for p in (ROOT / "greybox_torch").rglob("__init__.py"))


@pytest.mark.parametrize("package", PACKAGES)
def test_what_a_package_exports_is_there_and_described(package: str) -> None:
    module = importlib.import_module(package)
    assert all(hasattr(module, name) for name in getattr(module, "__all__", ()))
    assert module.__doc__
