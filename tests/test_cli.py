"""Exit codes and help, common to all commands."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest
from typer.testing import CliRunner

import greybox_torch
from greybox_torch.cli import app
from greybox_torch.commands import inspect
from greybox_torch.errors import NumericalError, UserError


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (UserError("[channels] u: found x"), 2, "error: [channels] u: found x\n"),
        (NumericalError("the step size vanished"), 3, "the numbers failed: the step size vanished\n"),
        (KeyboardInterrupt(), 130, "interrupted\n"),
    ],
)
def test_exit_codes(monkeypatch: pytest.MonkeyPatch, error: BaseException, code: int, message: str) -> None:
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(inspect, "run", fail)
    result = CliRunner().invoke(app, ["inspect", "dataset.toml"])
    assert result.exit_code == code
    assert result.stderr == message
    assert result.stdout == ""


def test_a_bug_is_not_dressed_up_as_a_user_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inspect, "run", lambda *_: 1 / 0)
    assert isinstance(CliRunner().invoke(app, ["inspect", "dataset.toml"]).exception, ZeroDivisionError)


@pytest.mark.parametrize(
    "arguments", [["inspect"], ["inspect", "a.toml", "--sed", "1"], ["inspct"], ["inspect", "a", "--seed", "x"]]
)
def test_wrong_usage(arguments: list[str]) -> None:
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert result.stdout == ""


def test_version() -> None:
    result = CliRunner().invoke(app, ["--version"])
    assert (result.exit_code, result.stdout) == (0, greybox_torch.__version__ + "\n")


@pytest.mark.parametrize("module", ["greybox_torch", "greybox_torch.cli"])
def test_run_as_a_module(module: str) -> None:
    """Seen: `python -m greybox_torch.cli` printed nothing, and ended with 0."""
    result = subprocess.run([sys.executable, "-m", module, "--version"], capture_output=True, text=True, check=True)
    assert (result.stdout, result.stderr) == (greybox_torch.__version__ + "\n", "")


def test_fleet_loads_torch_where_something_has_to_be_done() -> None:
    """Seen: 10 s to say that nothing had changed."""
    look = (
        "import sys, greybox_torch.commands.fleet; print(sorted({'torch', 'scipy', 'distributed'} & set(sys.modules)))"
    )
    result = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True, check=True)
    assert result.stdout == "[]\n"


@pytest.mark.parametrize("arguments", [["--help"], ["inspect", "--help"]])
def test_help_loads_nothing_heavy(arguments: list[str]) -> None:
    """That it answers at once is for a benchmark to say; what would keep it is seen here."""
    command = [sys.executable, "-X", "importtime", "-m", "greybox_torch", *arguments]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    loaded = {line.rsplit("|", 1)[-1].strip() for line in result.stderr.splitlines()}
    assert "Usage" in result.stdout and "greybox_torch.cli" in loaded
    assert not loaded & {"torch", "numpy", "pandas", "scipy", "matplotlib"}


def test_no_warning_of_a_library_reaches_the_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    import logging
    import warnings

    def warn(*_: object) -> None:
        warnings.warn("overflow in something", RuntimeWarning, stacklevel=1)
        warnings.warn("old", UserWarning, stacklevel=1)
        logging.getLogger("some.library").warning("no font")

    monkeypatch.setattr(sys, "warnoptions", [])
    monkeypatch.setattr(inspect, "run", warn)
    before = list(warnings.filters), list(logging.getLogger().handlers)
    result = CliRunner().invoke(app, ["inspect", "dataset.toml"])
    assert (result.exit_code, result.output) == (0, "")
    assert (list(warnings.filters), list(logging.getLogger().handlers)) == before


@pytest.mark.parametrize(
    ("command", "function", "given"),
    [("fit", "fit", "dataset.toml"), ("diagnose", "diagnose", "dataset.toml"), ("design", "design", "")],
)
def test_ctrl_c_says_that_nothing_is_written(
    motor_folder: Callable[..., Path], monkeypatch: pytest.MonkeyPatch, command: str, function: str, given: str
) -> None:
    """Seen: "interrupted" alone, after minutes, and no word on whether there were results."""

    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    folder = motor_folder()
    monkeypatch.setattr(import_module(f"greybox_torch.commands.{command}"), function, stopped)
    result = CliRunner().invoke(app, [command, str(folder / given), "--out", str(folder / "out")])
    assert result.exit_code == 130
    assert result.stderr.endswith("interrupted; nothing is written\n")
    assert not (folder / "out").exists()
