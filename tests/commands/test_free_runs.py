"""`simulate`, `compare` and `residuals`: free runs of the start values and of checkpoints."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import greybox_torch as gt
from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.cli import app

Make = Callable[..., Path]
Edit = Callable[[Path, str, str], None]
PNG = b"\x89PNG"


def greybox(command: str, folder: Path, *options: str) -> Result:
    arguments = [command, str(folder / "dataset.toml"), *options]
    return CliRunner().invoke(app, arguments if "--out" in options else [*arguments, "--out", str(folder / "out")])


def of(command: str, folder: Path, *options: str) -> dict[str, Any]:
    result = greybox(command, folder, "--json", *options)
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def saved(folder: Path, stem: str, inertia: float = 0.02, damping: float = 0.05, **changes: Any) -> str:
    units = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}
    options = {
        "model": f"{folder.resolve()}/my_motor.py:Motor",
        "title": "Motor",
        "values": {"J": inertia, "k": 0.1, "b": damping},
        **changes,
    }
    options["units"] = {name: units.get(name, "kg m^2") for name in options["values"]}
    save_checkpoint(folder / stem, Checkpoint(**options))
    return str(folder / stem)


def test_simulate(motor_folder: Make) -> None:
    folder = motor_folder()
    found = of("simulate", folder)
    assert (found["schema"], found["dataset"]) == ("greybox-compare/1", "Motor on the bench")
    (model,) = found["models"]
    assert model["name"] == "start"
    assert [(r["experiment"], r["role"], r["output"]) for r in model["fit"]] == [
        ("Steps", "estimation", "speed"),
        ("More steps", "estimation", "speed"),
        ("Sweep", "validation", "speed"),
    ]
    assert [Path(p).name for p in found["tables"]] == [
        "simulated_1_steps.csv",
        "simulated_2_more_steps.csv",
        "simulated_3_sweep.csv",
    ]
    for row, table, figure in zip(model["fit"], found["tables"], found["figures"], strict=True):
        columns = np.genfromtxt(table, delimiter=",", names=True)
        assert columns.dtype.names == ("time", "speed_measured", "speed_simulated")
        errors = columns["speed_measured"] - columns["speed_simulated"]
        assert np.sqrt(np.mean(errors**2)) == pytest.approx(row["rmse"], rel=1e-6)
        spread = np.linalg.norm(columns["speed_measured"] - columns["speed_measured"].mean())
        assert 100 * (1 - np.linalg.norm(errors) / spread) == pytest.approx(row["fit"], rel=1e-6)
        assert columns["time"][:3].tolist() == [0.0, 0.01, 0.02]
        assert Path(figure).read_bytes().startswith(PNG)
    assert sorted(str(p) for p in (folder / "out").iterdir()) == sorted(found["tables"] + found["figures"])


def test_simulate_of_data_with_gaps(motor_folder: Make) -> None:
    folder = motor_folder()
    lines = (folder / "steps.csv").read_text().splitlines()
    lines[5:9] = [line.split(",")[0] + "," for line in lines[5:9]]
    (folder / "steps.csv").write_text("\n".join(lines) + "\n")
    columns = np.genfromtxt(of("simulate", folder)["tables"][0], delimiter=",", names=True)
    assert np.flatnonzero(np.isnan(columns["speed_measured"])).tolist() == [4, 5, 6, 7]
    assert np.isfinite(columns["speed_simulated"]).all()


def test_simulate_for_people(motor_folder: Make) -> None:
    result = greybox("simulate", motor_folder())
    assert (result.exit_code, result.stderr) == (0, "")
    lines = [line.split() for line in result.stdout.splitlines()]
    assert ["experiment", "role", "output", "fit", "[%]", "rmse", "unit"] in lines
    assert any(line[:3] == ["Sweep", "validation", "speed"] and line[-1] == "rad/s" for line in lines)
    assert "simulated_3_sweep.csv" in result.stdout


@pytest.mark.parametrize("command", ["simulate", "residuals"])
def test_simulation_that_overflows(motor_folder: Make, edit: Edit, command: str) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "+ 9.0 * x.speed")
    result = greybox(command, folder)
    assert result.exit_code == 3
    assert result.stderr.startswith("the numbers failed: simulating Motor: the simulation of 'Steps' overflows at ")
    assert "try parameters" in result.stderr
    assert not (folder / "out").exists()


def test_overflow_comes_with_start_values_that_avoid_it(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "+ 9.0 * x.speed")
    said = greybox("simulate", folder).stderr
    value = said.split("it does not with J = ")[1].split(" ")[0]
    edit(folder / "dataset.toml", "J = { value = 0.03 }", f"J = {{ value = {value} }}")
    assert greybox("simulate", folder).exit_code == 0


@pytest.mark.parametrize("command", ["simulate", "compare", "residuals"])
def test_single_precision(motor_folder: Make, command: str) -> None:
    folder = motor_folder()
    double, single = (of(command, folder, "--precision", precision) for precision in ("double", "single"))
    rows = [found["residuals"] if command == "residuals" else found["models"][0]["fit"] for found in (double, single)]
    assert [r["rmse"] for r in rows[1]] == pytest.approx([r["rmse"] for r in rows[0]], rel=1e-3)
    assert [r["rmse"] for r in rows[1]] != [r["rmse"] for r in rows[0]]
    result = greybox(command, folder, "--precision", "half")
    assert result.exit_code == 2
    assert result.stderr == 'error: --precision half: expected "double" or "single"\n'


@pytest.mark.parametrize("command", ["simulate", "compare"])
def test_substeps_are_told(motor_folder: Make, edit: Edit, command: str) -> None:
    folder = motor_folder()
    assert of(command, folder)["models"][0]["substeps"] == 1
    assert "Runge-Kutta" not in greybox(command, folder).stdout
    edit(folder / "dataset.toml", "J = { value = 0.03 }", "J = { value = 0.0004 }")
    steps = of(command, folder)["models"][0]["substeps"]
    assert steps > 1
    assert f"is simulated in {steps} Runge-Kutta steps: the motion is fast" in greybox(command, folder).stdout.replace(
        "Each sample of start", "Each sample"
    )


def test_compare(motor_folder: Make) -> None:
    folder = motor_folder()
    found = of("compare", folder, saved(folder, "good"), saved(folder, "poor", 0.1) + ".json")
    assert [m["name"] for m in found["models"]] == ["start", "good", "poor"]
    start, good, poor = ([row["fit"] for row in m["fit"]] for m in found["models"])
    assert all(p < s < g for p, s, g in zip(poor, start, good, strict=True))
    assert min(good) > 95
    assert [Path(p).name for p in found["figures"]] == [
        "comparison_1_steps.png",
        "comparison_2_more_steps.png",
        "comparison_3_sweep.png",
    ]
    assert all(Path(p).read_bytes().startswith(PNG) for p in found["figures"])
    people = greybox("compare", folder, saved(folder, "good"))
    assert ["start", "start", "good", "good"] in [line.split() for line in people.stdout.splitlines()]


def test_compare_without_a_checkpoint(motor_folder: Make) -> None:
    folder = motor_folder()
    compared, simulated = of("compare", folder), of("simulate", folder)
    assert compared["models"] == simulated["models"]


def test_compare_with_what_fit_wrote(motor_folder: Make) -> None:
    folder = motor_folder()
    fitted = of("fit", folder)
    found = of("compare", folder, fitted["checkpoint"] + ".safetensors")
    (row,) = [r for r in found["models"][1]["fit"] if r["role"] == "validation"]
    (own,) = [r for r in fitted["fit"] if r["role"] == "validation"]
    assert row["fit"] == pytest.approx(own["refit"]["fit"], rel=1e-9)
    assert [r["fit"] for r in found["models"][0]["fit"]] == [r["start"]["fit"] for r in fitted["fit"]]


def test_names_of_checkpoints(motor_folder: Make) -> None:
    folder = motor_folder()
    one, other, start = saved(folder, "a/model"), saved(folder, "b/model"), saved(folder, "start")
    found = of("compare", folder, one, other, start, other)
    assert [m["name"] for m in found["models"]] == ["start", one, other, start, f"{other} (2)"]


def test_compare_with_one_that_overflows(motor_folder: Make) -> None:
    """It is reported so; the others are not held up."""
    folder = motor_folder()
    result = greybox("compare", folder, saved(folder, "wild", 1e-9))
    assert result.exit_code == 0
    assert "overflow" in result.stdout
    numbers = of("compare", folder, saved(folder, "wild", 1e-9))["models"]
    assert [row["fit"] for row in numbers[1]["fit"]] == [None] * 3
    assert min(row["fit"] for row in numbers[0]["fit"]) > 0
    assert numbers[0]["overflow"] is None
    assert numbers[1]["overflow"].startswith("the simulation of 'Steps' overflows at ")
    assert f"wild: {numbers[1]['overflow']}" in result.stdout


def test_checkpoint_of_a_model_that_has_moved(motor_folder: Make) -> None:
    folder = motor_folder()
    path = saved(folder, "good", model="/gone/since/my_motor.py:Motor")
    assert min(row["fit"] for row in of("compare", folder, path)["models"][1]["fit"]) > 95
    lost = saved(folder, "lost", model="/gone/since/my_engine.py:Engine", title="Engine")
    result = greybox("compare", folder, lost)
    assert result.exit_code == 2
    assert "lost: is of the model Engine in /gone/since/my_engine.py:Engine, not of Motor" in result.stderr


def test_checkpoint_of_another_structure(motor_folder: Make) -> None:
    """A model file is run where the user names it, not on a checkpoint's word; the card's parameters do not apply to it."""
    folder = motor_folder()
    text = (folder / "my_motor.py").read_text()
    text = text.replace("class Motor", "class Lag").replace('"J"', '"T"').replace("/ p.J", "/ p.T")
    (folder / "lag.py").write_text(f"open({str(folder / 'was_run')!r}, 'w').close()\n{text}")
    file = f"{folder.resolve()}/lag.py:Lag"
    path = saved(folder, "lag", model=file, title="Lag", values={"T": 0.02, "k": 0.1, "b": 0.05})
    result = greybox("compare", folder, path)
    assert result.exit_code == 2
    assert "a model file is run only where you name it yourself" in result.stderr
    assert not (folder / "was_run").exists()
    data = gt.load_dataset(folder / "dataset.toml")
    start, lag = gt.load_model(str(data.model)), gt.load(path, file)
    rows = [row for row in gt.compare(data, {"start": start, "lag": lag}).scores if row["model"] == "lag"]
    assert len(rows) == 3 and min(row["fit"] for row in rows) > 95


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"values": {"J": 0.02, "b": 0.05}}, ["holds the parameters of model Motor", "it lacks k"]),
        ({"values": {"J": 0.02, "k": 0.1, "b": 0.05, "c": 1.0}}, ["it has c"]),
        ({"model": "robot_arm", "title": "robot_arm"}, ["which are not those of robot_arm: it lacks F_v"]),
    ],
)
def test_checkpoints_that_do_not_fit(motor_folder: Make, changes: dict[str, Any], expected: list[str]) -> None:
    folder = motor_folder()
    for command, option in (("compare", []), ("residuals", ["--checkpoint"])):
        result = greybox(command, folder, *option, saved(folder, "odd", **changes))
        assert result.exit_code == 2
        assert all(text in result.stderr for text in expected), result.stderr
        assert not (folder / "out").exists()


def test_checkpoint_that_is_damaged(motor_folder: Make) -> None:
    folder = motor_folder()
    path = saved(folder, "broken")
    Path(path + ".safetensors").write_bytes(b"nonsense")
    result = greybox("compare", folder, path)
    assert result.exit_code == 2
    assert "broken.safetensors: damaged" in result.stderr
    result = greybox("compare", folder, str(folder / "nowhere"))
    assert result.exit_code == 2
    assert "nowhere.safetensors: no such file" in result.stderr


def test_residuals(motor_folder: Make) -> None:
    """The right parameters leave white noise; the start values leave what the input explains."""
    folder = motor_folder()
    right = of("residuals", folder, "--checkpoint", saved(folder, "good"))
    assert (right["schema"], right["model"]["name"]) == ("greybox-residuals/1", "good")
    wrong = of("residuals", folder)
    assert wrong["model"]["name"] == "start"
    for good, poor in zip(right["residuals"], wrong["residuals"], strict=True):
        assert (good["experiment"], good["role"], good["output"]) == (poor["experiment"], poor["role"], poor["output"])
        assert good["rmse"] == pytest.approx(0.02, rel=0.15)
        assert good["whiteness"]["bound"] == pytest.approx(
            2.58 / np.sqrt(400 if good["experiment"] == "More steps" else 600)
        )
        assert (good["whiteness"]["lags"], good["input_correlation"]["lags"]) == (25, 26)
        assert good["whiteness"]["value"] < 1.5 * good["whiteness"]["bound"] < 0.5 < poor["whiteness"]["value"]
        crossed = good["input_correlation"]
        assert crossed["input"] == "voltage"
        assert crossed["inputs"] == {"voltage": {k: crossed[k] for k in ("value", "bound", "lags_outside", "lags")}}
        assert crossed["value"] < 1.5 * crossed["bound"]
    assert sum(row["whiteness"]["lags_outside"] for row in right["residuals"]) <= 3
    assert any(row["input_correlation"]["value"] > row["input_correlation"]["bound"] for row in wrong["residuals"])
    assert Path(right["figure"]).read_bytes().startswith(PNG)
    assert [p.name for p in (folder / "out").iterdir()] == ["residuals.png"]


def test_residuals_for_people(motor_folder: Make) -> None:
    result = greybox("residuals", motor_folder())
    assert (result.exit_code, result.stderr) == (0, "")
    assert "residuals of Motor, start" in result.stdout
    assert any(line.split()[:3] == ["Sweep", "validation", "speed"] for line in result.stdout.splitlines())


def test_residuals_of_a_model_without_inputs(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", '    inputs = [Input("voltage", "V")]\n', "")
    edit(folder / "my_motor.py", "p.k * u.voltage - p.b", "-p.b")
    edit(folder / "dataset.toml", 'voltage = { column = "v", unit = "V" }\n', "")
    assert [row["input_correlation"] for row in of("residuals", folder)["residuals"]] == [None] * 3
