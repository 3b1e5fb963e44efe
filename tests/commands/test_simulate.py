"""`simulate`, and what all free runs tell: overflow, precision, sub-steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch import load_dataset, load_model, simulate
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from tests.commands.free_running import PNG, Edit, Make, greybox, of, saved


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
    assert list(model["initial"]) == ["Steps", "More steps", "Sweep"]  # with which an exported model does the same
    assert all(list(states) == ["speed"] for states in model["initial"].values())
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


@pytest.mark.usefixtures("unpainted")
def test_simulate_with_a_checkpoint(motor_folder: Make) -> None:
    """The fitted model's signals as CSV: seen missing on the command line."""
    folder = motor_folder()
    found = of("simulate", folder, "--checkpoint", saved(folder, "good"))
    (model,) = found["models"]
    assert model["name"] == "good"
    for row, table in zip(model["fit"], found["tables"], strict=True):
        columns = np.genfromtxt(table, delimiter=",", names=True)
        errors = columns["speed_measured"] - columns["speed_simulated"]
        assert np.sqrt(np.mean(errors**2)) == pytest.approx(row["rmse"], rel=1e-6) == pytest.approx(0.02, rel=0.15)


def test_simulate_of_data_with_gaps(motor_folder: Make) -> None:
    folder = motor_folder()
    lines = (folder / "steps.csv").read_text().splitlines()
    lines[5:9] = [line.split(",")[0] + "," for line in lines[5:9]]
    (folder / "steps.csv").write_text("\n".join(lines) + "\n")
    columns = np.genfromtxt(of("simulate", folder)["tables"][0], delimiter=",", names=True)
    assert np.flatnonzero(np.isnan(columns["speed_measured"])).tolist() == [4, 5, 6, 7]
    assert np.isfinite(columns["speed_simulated"]).all()


def test_stamps_since_1970_keep_their_fractions(motor_folder: Make, edit: Edit) -> None:
    """Ten digits are as many as such stamps have before the point: hundred samples of a second had one time."""
    folder = motor_folder()
    for file in folder.glob("*.csv"):
        names, *rows = file.read_text().splitlines()
        stamped = [f"2026-03-01T12:00:{0.01 * k:05.2f},{row}" for k, row in enumerate(rows)]
        file.write_text("\n".join([f"t,{names}", *stamped[:6000]]) + "\n")
    edit(folder / "dataset.toml", "sample_time = 0.01", 'time = "t"')
    columns = np.genfromtxt(of("simulate", folder)["tables"][0], delimiter=",", names=True)
    np.testing.assert_allclose(
        columns["time"], 0.01 * np.arange(len(columns)), atol=2e-7
    )  # from the start, as in figures


@pytest.mark.usefixtures("unpainted")
def test_simulate_for_people(motor_folder: Make) -> None:
    result = greybox("simulate", motor_folder())
    assert (result.exit_code, result.stderr) == (0, "")
    lines = [line.split() for line in result.stdout.splitlines()]
    assert ["experiment", "role", "output", "fit", "[%]", "rmse", "unit"] in lines
    assert any(line[:3] == ["Sweep", "validation", "speed"] and line[-1] == "rad/s" for line in lines)
    assert "simulated_3_sweep.csv" in result.stdout


@pytest.mark.usefixtures("unpainted")
def test_a_reversed_sign_is_told(motor_folder: Make, edit: Edit) -> None:
    """Seen: a sensor with its sign reversed, searched for two minutes and reported as something without a name."""
    folder = motor_folder()
    assert of("simulate", folder)["warnings"] == []
    edit(
        folder / "dataset.toml",
        'speed = { column = "w", unit = "rad/s" }',
        'speed = { column = "w", unit = "rad/s", scale = -1.0 }',
    )
    (told,) = of("simulate", folder)["warnings"]
    assert told.startswith("speed: the simulation moves opposite to the measurement") and "Check the sign" in told
    assert "warning: speed: the simulation moves opposite" in greybox("simulate", folder).stdout


@pytest.mark.parametrize("command", ["simulate", "residuals"])
def test_simulation_that_overflows(motor_folder: Make, edit: Edit, command: str) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "+ 9.0 * x.speed")
    result = greybox(command, folder)
    assert result.exit_code == 3
    assert result.stderr.startswith("the numbers failed: simulating Motor: the simulation of 'Steps' overflows at ")
    assert "try parameters" in result.stderr
    assert not (folder / "out").exists()


def test_finite_numbers_whose_squares_are_none_overflow(motor_folder: Make, edit: Edit) -> None:
    """Seen: a negative inertia, 1e261 in the figure, "overflow" in every row, and exit code 0."""
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "+ 3.0 * x.speed")
    result = greybox("simulate", folder)
    assert result.exit_code == 3, result.stdout
    assert ", of 'More steps' at " in result.stderr


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_some_experiments_overflow(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "+ 3.0 * x.speed")
    edit(folder / "dataset.toml", 'role = "validation"', 'role = "validation"\nrows = [0, 30]')
    result = greybox("simulate", folder)
    assert result.exit_code == 0, result.stderr
    assert "warning: the simulation of 'Steps' overflows at " in result.stdout and "it does not with" in result.stdout
    data = load_dataset(folder / "dataset.toml")
    found = simulate(load_model(str(data.model)), data)
    assert "overflows at" in found.warnings[0]
    axes = found.plot("Steps").axes
    assert max(abs(limit) for one in axes for limit in one.get_ylim()) < 50.0


def test_overflow_comes_with_start_values_that_avoid_it(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "+ 9.0 * x.speed")
    said = greybox("simulate", folder).stderr
    value = said.split("it does not with J = ")[1].split(" ")[0]
    edit(folder / "dataset.toml", "J = { value = 0.03 }", f"J = {{ value = {value} }}")
    assert greybox("simulate", folder).exit_code == 0


@pytest.mark.usefixtures("unpainted")
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


@pytest.mark.usefixtures("unpainted")
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


def test_the_title_says_which_values_and_effects(motor_folder: Make) -> None:
    """Seen: a model with effects and found values under "with its start values"."""
    data = load_dataset(motor_folder() / "dataset.toml")
    model = load_model(str(data.model))
    assert "Motor with its start values" in str(simulate(model, data))
    model.set_values({"b": 0.05})
    assert "Motor with the values that it holds" in str(simulate(model, data))
    around = Surroundings({"speed": Range(-6.0, 6.0, 3.0)}, {"speed": "rad/s"}, "N m", 0.01)
    rubbing = AugmentedModel(model, [Attachment("rotor", CoulombFriction())], {"rotor": around})
    assert "Motor with coulomb_friction at rotor" in str(simulate(rubbing, data))
