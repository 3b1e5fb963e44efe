from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from greybox_torch.cli import app

Edit = Callable[[Path, str, str], None]


@pytest.fixture(autouse=True)
def _work_beside_the_data(bench: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(bench.parent)
    monkeypatch.setenv("COLUMNS", "100")


def files(folder: Path) -> list[str]:
    """All files and folders below; Python's own cache of a model file is not a result."""
    paths = (path.relative_to(folder) for path in folder.rglob("*"))
    return sorted(str(path) for path in paths if "__pycache__" not in path.parts)


def test_table_and_figure(bench: Path) -> None:
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml"])
    assert (result.exit_code, result.stderr) == (0, "")
    lines = [line.split() for line in result.stdout.splitlines()]
    assert "Steps (estimation): steps.csv, rows = [0, 40], 0.39 s" in result.stdout
    assert ["channel", "unit", "samples", "sample", "time", "[s]", "min", "max", "std", "missing"] in lines
    assert ["voltage", "V", "40", "0.01", "0", "4", "1.414", "0"] in lines
    assert ["speed", "rad/s", "20", "0.01", "-2", "2", "1.214", "0"] in lines
    figure = Path("results/bench/channels.png")
    assert "Written to results/bench: channels.png" in result.stdout
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert files(Path("results")) == ["bench", "bench/channels.png"]


WITHOUT_TORCH = """
import sys
from greybox_torch.__main__ import main
try:
    main()
finally:
    assert "torch" not in sys.modules
"""


def test_data_alone_are_looked_at_without_torch(bench: Path) -> None:
    """Seen: a second of waiting for torch, for the sake of one list of names in a sentence."""
    command = [sys.executable, "-c", WITHOUT_TORCH, "inspect", "bench/dataset.toml"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Steps (estimation)" in done.stdout


def test_json(bench: Path) -> None:
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml", "--json", "--out", "here"])
    assert result.exit_code == 0
    output = json.loads(result.stdout)
    assert (output["schema"], output["dataset"]) == ("greybox-inspect/1", "Bench motor")
    assert [(e["name"], e["role"]) for e in output["experiments"]] == [("Steps", "estimation"), ("Sweep", "validation")]
    speed = 2.0 * np.delete(np.arange(40) / 4, 7)
    assert output["experiments"][0]["channels"]["speed"] == {
        "samples": 40,
        "sample_time": 0.01,
        "min": 0.0,
        "max": 19.5,
        "std": pytest.approx(speed.std()),
        "missing": 1,
        "unit": "rad/s",
    }
    assert Path(output["figure"]).exists()
    assert "Steps (estimation)" in result.stderr


def test_says_that_the_last_quarter_is_held_out(bench: Path, edit: Edit) -> None:
    edit(bench / "dataset.toml", 'role = "validation"', "")
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml"])
    assert "Steps (held out) (validation): steps.csv, rows = [30, 40]" in result.stdout
    assert "the last quarter of each is held out" in result.stdout


MOTOR = '''
from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State

class Motor(GreyBoxModel):
    """First-order motor: J dw/dt = k v - b w."""
    states = [State("speed", "rad/s")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("J", 0.01, unit="kg m^2", lower=0.0)]
    ports = [Body("rotor", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (u.voltage - x.speed + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}
'''


def test_checks_the_card_against_a_model(bench: Path, edit: Edit) -> None:
    (bench / "my_motor.py").write_text(MOTOR)
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml", "--model", "bench/my_motor.py:Motor"])
    assert (result.exit_code, result.stderr) == (0, "")
    assert "fit the model bench/my_motor.py:Motor." in result.stdout
    edit(bench / "dataset.toml", "[model.parameters]", '[model]\nname = "my_motor.py:Motor"\n[model.parameters]')
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml", "--json"])
    assert json.loads(result.stdout)["model"] == f"{bench.resolve()}/my_motor.py:Motor"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('speed = { column = "y", unit = "rad/s"', 'spede = { column = "y", unit = "rad/s"', ["[channels]", "'speed'"]),
        ('unit = "V"', 'unit = "mV"', ["[channels]", "'V'", "mV"]),
        ("J = {", "Jay = {", ["[model.parameters] Jay"]),
        (
            "value = 0.5, lower = 0.0",
            "value = -0.5, lower = -1.0, upper = -0.6",
            ["J: value = -0.5", "above upper = -0.6"],
        ),
        ("value = 0.5, lower = 0.0", "value = -0.5", ["J", "-0.5 lies outside its bounds"]),
        ("[model.parameters]", "[model.initial]\nspin = { value = 0.0 }\n[model.parameters]", ["[model.initial] spin"]),
    ],
)
def test_card_that_does_not_fit_the_model(bench: Path, edit: Edit, old: str, new: str, expected: list[str]) -> None:
    (bench / "my_motor.py").write_text(MOTOR)
    edit(bench / "dataset.toml", ", upper = 1.0", "")
    edit(bench / "dataset.toml", old, new)
    check_refused(bench, ["--model", "bench/my_motor.py:Motor"], expected)


@pytest.mark.parametrize(
    ("model", "content", "expected"),
    [
        ("no_such_system", "", "model 'no_such_system' is unknown"),
        ("bench/nowhere.py:Motor", "", "bench/nowhere.py: no such file"),
        ("bench/my_motor.py:Engine", MOTOR, "'Engine' is not defined"),
        ("bench/my_motor.py:Motor", "1 / 0", "my_motor.py, line 1: running it raised ZeroDivisionError"),
    ],
)
def test_model_that_cannot_be_loaded(bench: Path, model: str, content: str, expected: str) -> None:
    (bench / "my_motor.py").write_text(content)
    check_refused(bench, ["--model", model], [expected])


def test_out_that_is_a_file(bench: Path) -> None:
    Path("taken").touch()
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml", "--out", "taken"])
    assert result.exit_code == 2
    assert "--out taken: taken is a file; expected a folder for results" in result.stderr
    assert result.stdout == ""


BAD_INPUT = {
    "malformed TOML": ("dataset.toml", 'hold = "zoh"', "hold zoh", ["dataset.toml: not valid TOML", "at line 3"]),
    "unknown key": (
        "dataset.toml",
        "hold =",
        "hols =",
        ['unknown key "hols" (did you mean "hold"?)', "expected name, "],
    ),
    "missing file": ("dataset.toml", "steps.csv", "stops.csv", ["bench/stops.csv: no such file", "steps.csv"]),
    "unknown format": (
        "dataset.toml",
        "steps.csv",
        "steps.xls",
        ['files ending in ".xls"', ".csv, .mat, .npz, .parquet"],
    ),
    "missing column": (
        "dataset.toml",
        '"y"',
        '"Yy"',
        ['steps.csv: no column "Yy" (did you mean "y"?)', "found t, u, y"],
    ),
    "text in a column": ("steps.csv", "\n0.19,4,", "\n0.19,four,", ['steps.csv, line 21, column "u": found "four"']),
    "infinite value": (
        "steps.csv",
        "\n0.19,4,",
        "\n0.19,inf,",
        ['dataset.toml, [[experiment]] "Steps", channel "voltage": ', 'steps.csv, line 21, column "u"', "found inf"],
    ),
    "zero sample time": ("dataset.toml", "= 0.01", "= 0.0", ["sample_time: 0 is not a sample time"]),
    "negative sample time": ("dataset.toml", "= 0.01", "= -1", ["sample_time: -1 is not a sample time"]),
    "time going backwards": ("dataset.toml", "sample_time = 0.01", 'time = "u"', ["line 7", "found 0 s after 4 s"]),
    "short experiment": (
        "dataset.toml",
        'role = "estimation"',
        "rows = [0, 9]",
        ['"Steps": has 9 samples', "at least 10"],
    ),
    "rows out of range": (
        "dataset.toml",
        'role = "estimation"',
        "rows = [0, 99]",
        ['"Steps", rows: found [0, 99]', "40"],
    ),
    "misspelt channel": ("dataset.toml", "{ voltage =", "{ volts =", ['"Sweep", columns: no channel is named "volts"']),
    "repeated name": ("dataset.toml", '"Sweep"', '"Steps"', ['2 experiments are named "Steps"']),
    "value outside its bounds": ("dataset.toml", "value = 0.5", "value = 1.5", ["J: value = 1.5", "above upper = 1"]),
}


@pytest.mark.parametrize(("file", "old", "new", "expected"), BAD_INPUT.values(), ids=BAD_INPUT)
@pytest.mark.parametrize("options", [[], ["--json"]], ids=["", "json"])
def test_bad_input(
    bench: Path, edit: Edit, file: str, old: str, new: str, expected: list[str], options: list[str]
) -> None:
    edit(bench / file, old, new)
    check_refused(bench, options, expected)


def test_all_nan_channel(bench: Path) -> None:
    np.savez(bench / "sweep.npz", u_val=np.full(20, np.nan), y=np.arange(20.0))
    check_refused(bench, [], ['"Sweep", channel "voltage": all 20 samples are missing (NaN)', "sweep.npz"])


def test_missing_card(bench: Path) -> None:
    (bench / "dataset.toml").unlink()
    check_refused(bench, [], ["bench/dataset.toml: no such file"])


def check_refused(bench: Path, options: list[str], expected: list[str]) -> None:
    """Exit code 2, one message with all that is expected in it, no traceback, nothing printed or written."""
    before = files(bench.parent)
    result = CliRunner().invoke(app, ["inspect", "bench/dataset.toml", *options])
    assert result.exit_code == 2
    assert isinstance(result.exception, SystemExit)
    assert result.stdout == ""
    assert result.stderr.startswith("error: ")
    assert result.stderr.count("\n") == 1
    for text in expected:
        assert text in result.stderr
    assert files(bench.parent) == before
