"""Faults in model files: what was changed in the documentation's motor, and the answer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

CLASS = "class Motor(GreyBoxModel):"
RETURN = 'return {"speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J}'

FAULTS = [
    (CLASS, "import sys; sys.exit(0)\n" + CLASS, "my_motor.py, line"),
    (CLASS, "quit()\n" + CLASS, "called sys.exit"),
    (CLASS, "raise SystemExit('x')\n" + CLASS, "running it called sys.exit(x)"),
    (CLASS, "1 / 0\n" + CLASS, "running it raised ZeroDivisionError"),
    (CLASS, "raise GeneratorExit\n" + CLASS, "running it raised GeneratorExit"),
    (CLASS, "import no_such_module_at_all\n" + CLASS, "running it raised ModuleNotFoundError"),
    (CLASS, "def f(): f()\nf()\n" + CLASS, "running it raised RecursionError"),
    (CLASS, "if True\n" + CLASS, "running it raised SyntaxError"),
    (CLASS, "\0" + CLASS, "running it raised"),
    (CLASS, "  x = 1\n y = 2\n" + CLASS, "running it raised IndentationError"),
    (CLASS, "class Motor:", "is not a GreyBoxModel"),
    (CLASS, "class Engine(GreyBoxModel):", "class 'Motor' is not defined; it defines Engine"),
    (RETURN, "raise SystemExit(3)", "called sys.exit(3)"),
    (RETURN, "return 1 / 0", "ZeroDivisionError"),
    (RETURN, "return None", "expected a dictionary"),
    (RETURN, "return {}", "Motor"),
    (RETURN, 'return {"velocity": x.speed}', "Motor"),
    (RETURN, 'return {"speed": "fast"}', "Motor"),
    (RETURN, 'return {"speed": u.volts}', "'volts'"),
    (RETURN, 'return {"speed": x.position}', "'position'"),
    (RETURN, 'return {"speed": p.mass}', "'mass'"),
    (RETURN, 'return {"speed": port.gear}', "'gear'"),
    (RETURN, "v = x.speed\n        v += 1.0\n        " + RETURN, "change the signals that they are given"),
    (RETURN, "u.voltage.mul_(2.0)\n        " + RETURN, "write a = a + b instead"),
    (RETURN, RETURN.replace("/ p.J}", "/ p.J * 1j}"), "Motor.derivative() returned complex numbers for speed"),
    (RETURN, RETURN.replace("/ p.J}", "/ p.J + __import__('torch').rand(())}"), "no random numbers"),
    ("return {\"speed\": x.speed}", "return {\"speed\": __import__('torch').zeros(3)}", "Motor.output() returned 'speed' of shape (3,)"),
    (RETURN, 'return {"speed": float(x.speed)}', "need the value of a signal"),
    (RETURN, 'return {"speed": x.speed if x.speed > 0 else -x.speed}', "need the value of a signal"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), FAULTS, ids=[f"{k}: {f[1]:.40}" for k, f in enumerate(FAULTS)])
def test_fault(spoilt: Path, answer: Callable[..., str], old: str, new: str, message: str) -> None:
    model = spoilt / "my_motor.py"
    assert old in model.read_text()
    model.write_text(model.read_text().replace(old, new, 1))
    answer("inspect", "dataset.toml", message=message)


def test_declarations(spoilt: Path, answer: Callable[..., str]) -> None:
    sound = (spoilt / "my_motor.py").read_text()
    for old, new, message in [
        ('Parameter("J", 0.01', 'Parameter("J", float("inf")', "J"),
        ('Parameter("J", 0.01', 'Parameter("J", float("nan")', "J"),
        ('Parameter("J", 0.01', 'Parameter("J", -1.0', "lies outside its bounds"),
        ('Parameter("J", 0.01', 'Parameter("J", "heavy"', "J"),
        ('Parameter("J", 0.01', 'Parameter("k", 0.01', "k"),
        ('State("speed", "rad/s")', 'State("speed", "rad/s", initial="guessed")', "speed"),
        ("states", "conditions", "Motor"),
        ('State("speed", "rad/s")', 'State("speed", "rad/s", initial=None)', "State 'speed': initial is None"),
        ('Body("rotor"', 'Body("actuator"', "rotor"),
    ]:
        assert old in sound
        (spoilt / "my_motor.py").write_text(sound.replace(old, new, 1))
        answer("inspect", "dataset.toml", message=message)


def test_what_it_prints_goes_to_standard_error(spoilt: Path) -> None:
    import json

    from typer.testing import CliRunner

    from greybox_torch.cli import app

    model = spoilt / "my_motor.py"
    model.write_text("print('loading')\n" + model.read_text().replace(RETURN, "print('rates')\n        " + RETURN))
    done = CliRunner().invoke(app, ["simulate", str(spoilt / "dataset.toml"), "--json", "--out", str(spoilt / "out")])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["schema"] == "greybox-compare/1"
