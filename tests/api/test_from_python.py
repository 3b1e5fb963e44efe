"""The contract's section 7: from arrays to a verdict, with the names that `import greybox_torch` gives."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest

import greybox_torch as gt
from tests.api.motor import Motor, check_shown, numbers, told


def test_simulate(folder: Path, data: gt.DataSet) -> None:
    model = Motor()
    found = gt.simulate(model, data)
    assert found["Sweep"]["speed"].shape == (600,) and list(found) == ["Steps", "More steps", "Sweep"]
    assert numbers(found.to_dict()) == numbers(told(folder, "simulate"))
    assert [row["fit"] for row in found.scores] == [row["fit"] for row in found.to_dict()["models"][0]["fit"]]
    assert found.scores[2].keys() == {"model", "experiment", "role", "output", "fit", "rmse", "unit"}
    assert 0.1 < found.initial["Steps"]["speed"] < 0.5
    assert model.held_values() == {} and found.model.held_values() == model.values()
    names = {f"simulated_{k}_{n}" for k, n in ((1, "steps"), (2, "more_steps"), (3, "sweep"))}
    check_shown(found, folder / "saved", {f"{name}.{kind}" for name in names for kind in ("csv", "png")})
    with pytest.raises(KeyError, match="no experiment 'sweep'; there are: Steps, More steps, Sweep"):
        _ = found["sweep"]
    with pytest.raises(KeyError, match="no output 'pos'; there are: speed"):
        _ = found["Sweep"]["pos"]


def test_fit(folder: Path, data: gt.DataSet) -> None:
    model = Motor()
    found = gt.fit(model, data, profiles=["J"])
    from_files = told(folder, "fit", "--profile", "J")
    assert numbers(found.to_dict()) == numbers(from_files)
    with pytest.raises(KeyError, match="no parameter 'b_x'; there are: J, k, b"):
        _ = found.parameters["b_x"]
    inertia = found.parameters["J"]
    assert (inertia.value, inertia.std) == (
        from_files["parameters"]["J"]["value"],
        from_files["parameters"]["J"]["std"],
    )
    assert (inertia.unit, inertia.fixed, found.parameters["k"].fixed) == ("kg m^2", False, True)
    assert found.initial["Steps"]["speed"].value == from_files["initial"]["Steps"]["speed"]["value"]
    assert found.model.values() == {name: entry.value for name, entry in found.parameters.items()}
    assert [row["name"] for row in found.parameter_rows] == ["J", "k", "b"]
    assert model.held_values() == {}
    assert {row["model"] for row in gt.simulate(found, data).scores} == {"refit"}
    assert {row["model"] for row in gt.simulate(model, data).scores} == {"start"}
    check_shown(found, folder / "saved", {"fit.json", "model.json", "model.safetensors", "profile_J.png"})
    assert gt.load(folder / "saved" / "model").values() == found.model.values()


def test_values_that_are_set_are_used(data: gt.DataSet) -> None:
    model = Motor()
    model.set_values({"J": 0.02, "b": 0.05})
    assert gt.simulate(model, data).run.values == {"J": 0.02, "k": 0.1, "b": 0.05}
    found = gt.fit(model, data)
    before = {row["experiment"]: row["fit"] for row in found.scores if row["model"] == "start"}
    assert before == {row["experiment"]: row["fit"] for row in gt.simulate(model, data).scores}
    assert model.values() == {"J": 0.02, "k": 0.1, "b": 0.05}


def test_the_contract(folder: Path, data: gt.DataSet) -> None:
    model = Motor()
    fit = gt.fit(model, data)
    found = gt.diagnose(fit.model, data, time_limit=60, settings=gt.DiagnosisSettings())
    (effect,) = found.effects
    assert (effect.port, effect.mechanism) == ("actuator", "actuator_deadzone")
    assert found.sentence == found.verdict.sentence and found.mismatch
    half_width = found.parameters["actuator.actuator_deadzone.half_width"]
    assert half_width.value == pytest.approx(0.4, rel=0.02) and 0 < (half_width.std or 0) < 0.01
    inertia = next(one for one in found.verdict.parameters if one.name == "J")
    assert inertia.augmented is not None and (found.parameters["J"].std, found.parameters["k"].std) == (
        inertia.augmented[1],
        None,
    )
    table = {row["parameter"]: row["value"] for row in found.effect_rows if row["mechanism"] == effect.mechanism}
    assert table["half_width"] == half_width.value and len(table) == len(effect.parameters)
    assert found.model.values() == {name: entry.value for name, entry in found.parameters.items()}
    assert (model.held_values(), fit.model.values()["J"]) == ({}, fit.parameters["J"].value)
    kept = {f"1-actuator-actuator_deadzone.{kind}" for kind in ("json", "safetensors")}
    files = {"hypotheses.json", "model.json", "model.safetensors", "report.html", "verdict.json"}
    check_shown(found, folder / "saved", files, {"hypotheses": kept})
    assert (folder / "saved" / "verdict.json").read_text() == found.to_json()

    compared = gt.compare(data, {"start": Motor(), "fit": fit, "diagnosed": found, "saved": folder / "saved" / "model"})
    rows = [[row["rmse"] for row in compared.scores if row["model"] == name] for name in compared]
    assert rows[3] == rows[2] and max(rows[2]) < 0.025 < min(rows[1]) < min(rows[0])
    assert compared["saved"]["Sweep"]["speed"].shape == (600,)
    check_shown(
        compared,
        folder / "drawn",
        {f"comparison_{k}_{n}.png" for k, n in ((1, "steps"), (2, "more_steps"), (3, "sweep"))},
    )

    loaded = gt.load(folder / "saved" / "model")
    assert loaded.values() == found.model.values()
    assert [row["rmse"] for row in gt.simulate(loaded, data).scores] == rows[2]
    assert [gt.simulate(one, data).name for one in (found, found.model, loaded)] == ["augmented"] * 3
    assert gt.residuals(found.model, data).name == "augmented" and len(repr(effect)) < 100
    again = gt.fit(loaded, data)
    assert again.parameters["actuator.actuator_deadzone.half_width"].value == pytest.approx(0.4, rel=0.02)
    assert not gt.diagnose(loaded, data).effects


def test_the_same_verdict_as_the_command_line(folder: Path, data: gt.DataSet) -> None:
    from_files = told(folder, "diagnose")
    assert numbers(gt.diagnose(Motor(), data).to_dict()) == numbers(from_files)


def test_residuals_and_inspect(folder: Path, data: gt.DataSet) -> None:
    left, seen = gt.residuals(Motor(), data), gt.inspect(data, Motor())
    assert numbers(left.to_dict()) == numbers(told(folder, "residuals"))
    assert numbers(seen.to_dict()) == numbers(told(folder, "inspect"))
    assert left.scores[0]["whiteness"] > left.scores[0]["bound"]
    assert repr(left).endswith("residuals of Motor, start>")
    fitted = gt.fit(Motor(), data)
    assert repr(gt.residuals(fitted, data)).endswith("residuals of Motor, refit>")
    assert repr(gt.residuals(fitted.model, data)).endswith("residuals of Motor, held values>")  # seen: "start"
    assert "Sweep (validation): 5.99 s<" in seen._repr_html_()
    assert [row["channel"] for row in seen.rows[:2]] == ["voltage", "speed"]
    check_shown(left, folder / "left", {"residuals.png"})
    check_shown(seen, folder / "seen", {"channels.png"})


def test_rows_become_a_data_frame(data: gt.DataSet) -> None:
    table = pandas.DataFrame(gt.simulate(Motor(), data).scores)
    assert list(table["experiment"]) == ["Steps", "More steps", "Sweep"]


def test_loading_does_not_need_the_diagnosis(folder: Path) -> None:
    told(folder, "fit")
    program = (
        "import sys, greybox_torch as gt\n"
        f"model = gt.load({str(folder / 'out' / 'model')!r}, {str(folder / 'my_motor.py:Motor')!r})\n"
        f"assert gt.simulate(model, gt.load_dataset({str(folder / 'dataset.toml')!r})).scores\n"
        "print([name for name in sys.modules if name.startswith('greybox_torch.diagnosis')])"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_a_frame_with_further_columns_is_told_how_to_leave_them_out() -> None:
    """Seen: a frame with the columns of the log beside those converted; of three that are no signals one was told, and not what to do."""
    samples = {name: np.linspace(0.0, 1.0, 30) for name in ("voltage", "speed", "U_mot", "n_rpm")}
    units = {"voltage": "V", "speed": "rad/s"}
    made = gt.Recording.from_dataframe("steps", samples, sample_time=0.01, units=units)
    with pytest.raises(
        gt.UserError, match=r"channels U_mot, n_rpm: model Motor has no such signal; .*, columns = \{"
    ) as error:
        gt.simulate(Motor(), gt.DataSet([made]))
    assert "frame" in str(error.value)
    named = {"voltage": "voltage", "speed": "speed"}
    made = gt.Recording.from_dataframe("steps", samples, sample_time=0.01, units=units, columns=named)
    assert "steps" in gt.simulate(Motor(), gt.DataSet([made]))


def test_channels_without_a_unit_are_told() -> None:
    """Seen: a speed in rpm was taken for rad/s without a word."""
    samples = {name: np.linspace(0.0, 1.0, 30) for name in ("voltage", "speed")}
    one = gt.Recording.from_arrays("steps", samples, sample_time=0.01, units={"voltage": "V"})
    said = "Channels without a unit are taken in the model's units: speed as rad/s."
    assert said in str(gt.inspect(gt.DataSet([one]), Motor()))
    both = gt.Recording.from_arrays("steps", samples, sample_time=0.01, units={"voltage": "V", "speed": "rad/s"})
    assert "without a unit" not in str(gt.inspect(gt.DataSet([both]), Motor()))
