"""Whatever a user's model file does on loading ends as one message, and never as an end of the program."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.cli import app
from greybox_torch.errors import UserError
from greybox_torch.systems import load_model

MOTOR = (Path(__file__).parents[1] / "machines" / "motor.py").read_text()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("import sys\nsys.exit(0)\n", r"motor.py, line 2: running it called sys.exit\(0\); expected a class"),
        ("exit('bye')\n", r"running it called sys.exit\(bye\)"),
        ("raise SystemExit\n", r"line 1: running it called sys.exit\(\)"),
        ("raise GeneratorExit\n", "line 1: running it raised GeneratorExit"),
        ("class Own(BaseException): ...\nraise Own('x')\n", "line 2: running it raised Own: x"),
        ("def f(): f()\nf()\n", "line 1: running it raised RecursionError"),
        ("raise MemoryError\n", "line 1: running it raised MemoryError"),
        (
            "class Own(Exception):\n    def __str__(self):\n        1 / 0\nraise Own\n",
            r"line 4: running it raised Own: \(its message cannot be shown\)",
        ),
        (
            MOTOR.replace(
                "def derivative(self, x, u, p, port):",
                "def derivative(self, x, u, p, port):\n        raise SystemExit(3)",
            ),
            r"class Motor, line \d+: trying its equations called sys.exit\(3\)",
        ),
        (MOTOR + "\n    def __init__(self):\n        quit()\n", r"line \d+: creating it called sys.exit"),
        ("x = '\udcff'".encode("utf-8", "surrogateescape").decode("latin-1"), "is not defined"),
        (MOTOR.replace("p.b", "p.bb"), r"motor.py, class Motor, line \d+: the equations ask for the parameter 'bb'"),
        (
            MOTOR.replace("unit=", "fix=True, unit=", 1),
            r"line \d+: running it raised TypeError: .*'fix' \(did you mean \"fixed\"\?\); it takes name, value, .*fixed",
        ),
        ("x = 1\x00\n", "running it raised (SyntaxError|ValueError): source code"),
    ],
)
def test_one_message(tmp_path: Path, content: str, message: str) -> None:
    file = tmp_path / "motor.py"
    file.write_text(content)
    with pytest.raises(UserError, match=message):
        load_model(f"{file}:Motor")


def test_ctrl_c_passes_through(tmp_path: Path) -> None:
    (tmp_path / "motor.py").write_text("raise KeyboardInterrupt\n")
    with pytest.raises(KeyboardInterrupt):
        load_model(f"{tmp_path}/motor.py:Motor")


def test_what_it_prints_does_not_spoil_json(motor_folder: Callable[..., Path]) -> None:
    folder = motor_folder()
    model = folder / "my_motor.py"
    model.write_text("print('loading')\n" + model.read_text())
    done = CliRunner().invoke(app, ["inspect", str(folder / "dataset.toml"), "--json", "--out", str(folder / "out")])
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["schema"] == "greybox-inspect/1"
    assert "loading" in done.stderr
