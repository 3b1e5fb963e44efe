"""`compare`: models and checkpoints side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import greybox_torch as gt
from tests.commands.free_running import PNG, Make, greybox, of, saved


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


@pytest.mark.usefixtures("unpainted")
def test_compare_without_a_checkpoint(motor_folder: Make) -> None:
    folder = motor_folder()
    compared, simulated = of("compare", folder), of("simulate", folder)
    assert compared["models"] == simulated["models"]


@pytest.mark.usefixtures("unpainted")
def test_compare_with_what_fit_wrote(motor_folder: Make) -> None:
    folder = motor_folder()
    fitted = of("fit", folder)
    found = of("compare", folder, fitted["checkpoint"] + ".safetensors")
    (row,) = [r for r in found["models"][1]["fit"] if r["role"] == "validation"]
    (own,) = [r for r in fitted["fit"] if r["role"] == "validation"]
    assert row["fit"] == pytest.approx(own["refit"]["fit"], rel=1e-9)
    assert [r["fit"] for r in found["models"][0]["fit"]] == [r["start"]["fit"] for r in fitted["fit"]]


@pytest.mark.usefixtures("unpainted")
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


@pytest.mark.usefixtures("unpainted")
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
    assert f"is of the model Lag in {file}, not of Motor; expected a checkpoint of Motor, or Lag as" in result.stderr
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
    assert "nowhere: no such file or folder" in result.stderr


@pytest.mark.usefixtures("unpainted")
def test_folders_of_results_are_taken(motor_folder: Make) -> None:
    folder = motor_folder()
    saved(folder, "good/model")
    found = of("compare", folder, str(folder / "good"))
    assert [m["name"] for m in found["models"]] == ["start", "good"]
    assert of("residuals", folder, "--checkpoint", str(folder / "good"))["model"]["name"] == "good"


@pytest.mark.parametrize(("own", "told"), [(99.5, False), (99.9, True), (None, False)])
def test_how_free_runs_begin_is_said_and_where_the_estimate_began_far_better(
    motor_folder: Make, own: float | None, told: bool
) -> None:
    """Seen: 53.9 % of a diagnosed model beside 97.5 % of the plain fit, without a word; the report has 98.1 %."""
    folder = motor_folder()
    data = gt.load_dataset(folder / "dataset.toml")
    place = {"experiment": "Steps", "role": "estimation", "output": "speed"}
    figures = [place | {"start": {"fit": 100.0, "rmse": 0.0}, "refit": {"fit": own, "rmse": 1.0}}]
    other = saved(folder, "other", 0.1, figures=figures, dataset="of other recordings", own_starts="refit")
    path = saved(folder, "own", 0.1 if told else 0.02, figures=figures, dataset=data.sha256, own_starts="refit")
    for line in ("compare", "simulate"):
        assert "begun with start states estimated on the first tenth" in greybox(line, folder).stdout
    warnings = of("compare", folder, path, other)["warnings"]
    assert len(warnings) == told
    assert all(w.startswith("own: speed of 'Steps' has a fit of ") and f"and of {own} %" in w for w in warnings)
