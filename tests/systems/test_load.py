from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.errors import UserError
from greybox_torch.systems import BUILT_IN, load_model

MOTOR = (Path(__file__).parents[1] / "machines" / "motor.py").read_text()


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in(name: str) -> None:
    assert load_model(name).title == name


def test_file_and_class(machines: Path) -> None:
    model = load_model(f"{machines / 'motor.py'}:Motor")
    assert model.title == "Motor"
    assert model.values() == {"J": 0.01, "k": 0.1, "b": 0.1}


@pytest.mark.parametrize(
    ("content", "name", "message"),
    [
        (
            MOTOR,
            "robot_leg",
            r"model 'robot_leg' is unknown; expected a built-in system \(robot_arm.*\) or a file and class",
        ),
        (
            MOTOR,
            "my_motor.py",
            "model 'my_motor.py' is a file; expected the class in it as well, such as my_motor.py:Motor",
        ),
        (MOTOR.replace("class Motor", "class Winch"), "my_motor.py", "such as my_motor.py:Winch"),
        ("1 +", "my_motor.py", "such as my_motor.py:Motor"),
        (MOTOR, "nowhere.py:Motor", "model file nowhere.py: no such file"),
        (MOTOR, "my_motor.py:Engine", "class 'Engine' is not defined; it defines Motor"),
        (MOTOR, "my_motor.py:Body", "class 'Body' is not a GreyBoxModel; it defines Motor"),
        ("x = 1", "my_motor.py:Motor", "class 'Motor' is not defined; it defines no GreyBoxModel"),
        (
            "x = 1\n1 / 0",
            "my_motor.py:Motor",
            "my_motor.py, line 2: running it raised ZeroDivisionError: division by zero",
        ),
        ("x = 1\nif x\n  pass", "my_motor.py:Motor", "my_motor.py, line 2: running it raised SyntaxError"),
        (
            "import nothing_like_it",
            "my_motor.py:Motor",
            "line 1: running it raised ModuleNotFoundError.*nothing_like_it",
        ),
        (MOTOR.replace("0.01, unit", "-0.01, unit"), "my_motor.py:Motor", "'J': value -0.01 lies outside its bounds"),
        (
            MOTOR.replace("u.voltage", "u.volts"),
            "my_motor.py:Motor",
            r"class Motor, line \d+: .*the input 'volts'.*declared: voltage",
        ),
        (MOTOR.replace("/ p.J", "/ 0"), "my_motor.py:Motor", None),
        (
            MOTOR.replace("x.speed}", "1 / 0}"),
            "my_motor.py:Motor",
            r"class Motor: my_motor.py, line \d+: .*ZeroDivisionError",
        ),
        (MOTOR.replace('{"speed": x.speed}', "x.speed"), "my_motor.py:Motor", "returned Tensor; expected a dictionary"),
        (
            MOTOR + "\n    def __init__(self):\n        raise OSError('no licence')\n",
            "my_motor.py:Motor",
            "OSError: no licence",
        ),
    ],
)
def test_what_can_be_wrong(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: str, name: str, message: str | None
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("my_motor.py").write_text(content)
    if message is None:  # dividing tensors by zero raises nothing; the simulation will tell
        load_model(name)
    else:
        with pytest.raises(UserError, match=message):
            load_model(name)
