"""The contract's section 7: from arrays to a verdict, with the names that `import greybox_torch` gives."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app

Make = Callable[..., Path]
UNITS = {"voltage": "V", "speed": "rad/s"}
ASIDE = {"seconds", "stages", "checkpoint", "tables", "figures", "figure", "sample_time"}


class Motor(gt.GreyBoxModel):
    """The documentation's motor with the start values of the card that the command line is given."""

    states = [gt.State("speed", "rad/s")]
    inputs = [gt.Input("voltage", "V")]
    outputs = [gt.Output("speed", "rad/s")]
    parameters = [
        gt.Parameter("J", 0.03, unit="kg m^2", lower=0.0),
        gt.Parameter("k", 0.10, unit="N m/V", lower=0.0, fixed=True),
        gt.Parameter("b", 0.08, unit="N m s/rad", lower=0.0, upper=1.0),
    ]
    ports = [gt.Body("rotor", speed="speed")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


@pytest.fixture
def folder(motor_folder: Make) -> Path:
    """The motor with a dead zone of 0.4 V that the model does not know."""
    return motor_folder(dead_zone=0.4)


@pytest.fixture
def data(folder: Path) -> gt.DataSet:
    """The same recordings from memory: one of a table, the others of arrays."""
    columns = {
        name: np.genfromtxt(folder / f"{name}.csv", delimiter=",", names=True) for name in ("steps", "more", "sweep")
    }
    arrays = {name: {"voltage": table["v"], "speed": table["w"]} for name, table in columns.items()}
    frame = pandas.DataFrame({"t": np.arange(600) * 0.01, **arrays["steps"]})
    steps = gt.Recording.from_dataframe("Steps", frame, time="t", role="estimation", units=UNITS)
    more = gt.Recording.from_arrays("More steps", arrays["more"], sample_time=0.01, role="estimation")
    sweep = gt.Recording.from_arrays("Sweep", arrays["sweep"], sample_time=0.01, role="validation", units=UNITS)
    return gt.DataSet([steps, more, sweep], hold="zoh", name="Motor on the bench")


def told(folder: Path, command: str, *options: str) -> dict[str, Any]:
    """What the command prints with --json for the same data on files."""
    arguments = [command, str(folder / "dataset.toml"), *options, "--json", "--out", str(folder / "out")]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def numbers(told: Any) -> Any:
    """Without what depends on the clock, and on where models and files are."""
    if isinstance(told, dict):
        names = [name for name in told if name not in ASIDE and not (name == "model" and isinstance(told[name], str))]
        return {name: numbers(told[name]) for name in names}
    return [numbers(value) for value in told] if isinstance(told, list) else told


def check_shown(result: Any, folder: Path, files: set[str], folders: dict[str, set[str]] | None = None) -> None:
    """Prints, shows itself, draws and saves; JSON is strict, and what it names is there."""
    below = folders or {}
    assert "Motor" in str(result) and len(repr(result)) < 300
    html = result._repr_html_()
    assert "<table>" in html and "data:image/png;base64," in html and "http" not in html
    assert isinstance(result.plot(), Figure)
    assert {path.name for path in result.save(folder)} == files.union(*below.values())
    assert {path.name for path in folder.iterdir()} == files | set(below)
    assert all({path.name for path in (folder / name).iterdir()} == inside for name, inside in below.items())
    text = result.to_json(folder)
    assert json.loads(text) == result.to_dict(folder) and text.endswith("}\n")


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


def test_fit(folder: Path, data: gt.DataSet) -> None:
    model = Motor()
    found = gt.fit(model, data, profiles=["J"])
    from_files = told(folder, "fit", "--profile", "J")
    assert numbers(found.to_dict()) == numbers(from_files)
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
    assert [row["channel"] for row in seen.rows[:2]] == ["voltage", "speed"]
    check_shown(left, folder / "left", {"residuals.png"})
    check_shown(seen, folder / "seen", {"channels.png"})


def test_rows_become_a_data_frame(data: gt.DataSet) -> None:
    table = pandas.DataFrame(gt.simulate(Motor(), data).scores)
    assert list(table["experiment"]) == ["Steps", "More steps", "Sweep"]


def test_train(folder: Path, data: gt.DataSet) -> None:
    model, options = Motor(), ("--net", "residual", "--port", "actuator", "--units", "4", "--epochs", "5")
    settings = gt.TrainingSettings(epochs=5)
    found = gt.train(model, data, net="residual", port="actuator", network={"units": 4}, settings=settings)
    assert numbers(found.to_dict()) == numbers(told(folder, "train", *options))
    assert found.parameters["actuator.residual_net.out_0"].unit == "V" and model.held_values() == {}
    assert found.model.held_values() == {row["name"]: row["value"] for row in found.parameter_rows}
    assert found.explanation is not None and found.explanation.term is not None and found.named is not None
    by_model = {(row["model"], row["experiment"]): row["fit"] for row in found.scores}
    compared = gt.compare(data, {"augmented": found, "named": found.named})
    for row in compared.scores:
        assert row["fit"] == pytest.approx(by_model[row["model"], row["experiment"]], abs=1e-6)
    assert found.force(input=np.array([2.0])).shape == (1,) and isinstance(found.plot_learned(), Figure)
    files = {f"{name}.{kind}" for name in ("model", "named") for kind in ("json", "safetensors")}
    check_shown(found, folder / "saved", {"train.json", "learned.png", *files})
    assert gt.load(folder / "saved" / "named").values() == found.named.values()


def test_a_training_that_explains_nothing(folder: Path, data: gt.DataSet) -> None:
    """Trained from the values that the model holds, on the very start values that a fit of it has."""
    model = Motor()
    model.set_values({"J": 0.02, "b": 0.05})
    options = {"net": "residual", "port": "actuator", "network": {"units": 2}}
    found = gt.train(model, data, settings=gt.TrainingSettings(epochs=1), explain=False, **options)
    assert (found.explanation, found.named, found.plot_learned()) == (None, None, None)
    start = [row["fit"] for row in found.scores if row["model"] == "start"]
    assert start == [row["fit"] for row in gt.simulate(model, data).scores]
    check_shown(found, folder / "saved", {"train.json", "model.json", "model.safetensors"})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m, d: gt.train(m, d, net="fiction"), "net: found 'fiction', unknown (did you mean \"friction\"?); expected"),
        (lambda m, d: gt.train(m, d, port="rotary"), "port: found 'rotary', model Motor has no such port"),
        (lambda m, d: gt.train(m, d, signals="speed"), "signals: found 'speed', expected a list of names, such as [\"speed\"]"),
        (lambda m, d: gt.train(m, d, ensemble=0), "ensemble: found 0, expected a whole number from 1 to 1000"),
        (lambda m, d: gt.train(m, d, resume=True), "resume: found True, expected a snapshot to take the training up from"),
        (lambda m, d: gt.train(m, d, settings=None), "settings: found None, expected TrainingSettings(…)"),
        (lambda m, d: gt.diagnose(m, d, time_limit=-1), "time_limit: found -1, expected a number above 0"),
        (lambda m, d: gt.diagnose(m, d, settings={}), "settings: found an object of type dict, expected DiagnosisSettings(…)"),
        (lambda m, d: gt.fit(m, d, starts=0), "starts: found 0, expected a whole number from 1 to 4096"),
        (lambda m, d: gt.fit(m, d, seed=-1), "seed: found -1, expected a whole number from 0 to 4294967295"),
        (lambda m, d: gt.fit(m, d, profiles="J"), "profiles: found 'J', expected a list of names, such as [\"J\"]"),
        (lambda m, d: gt.fit(m, d, profiles=["k"]), "profiles: found 'k', this parameter is fixed; expected one of"),
        (lambda m, d: gt.simulate(Motor, d), "model: found the class Motor, expected an object of it: Motor()"),
        (lambda m, d: gt.simulate("robot_arm", d), "model: found an object of type str, expected a model, or the result"),
        (lambda m, d: gt.simulate(m, "card.toml"), "data: found an object of type str, expected a DataSet"),
        (lambda m, d: gt.simulate(m, d, device="tpu"), "device: found 'tpu', expected \"cpu\", \"cuda\" or \"cuda:N\""),
        (lambda m, d: gt.simulate(m, d, precision="half"), "precision: found 'half', expected \"double\" or \"single\""),
        (lambda m, d: gt.compare(d, [m]), "models: found an object of type list, expected models by name"),
        (lambda m, d: gt.compare(d, {}), "models: found none, expected models by name"),
        (lambda m, d: gt.residuals(m, d).plot("sweep"), "experiment: found 'sweep', expected one of Steps, More steps, Sweep"),
        (lambda m, d: gt.simulate(m, d).plot("sweep"), "experiment: found 'sweep', expected one of Steps, More steps, Sweep"),
    ],
)  # fmt: skip
def test_arguments_at_fault(data: gt.DataSet, call: Callable[[Any, Any], Any], message: str) -> None:
    with pytest.raises(gt.UserError) as caught:
        call(Motor(), data)
    assert str(caught.value).startswith(message)


def test_nothing_is_half_saved(folder: Path, data: gt.DataSet) -> None:
    (folder / "saved" / "residuals.png").mkdir(parents=True)
    with pytest.raises(gt.UserError, match=r"residuals.png: cannot be written: it is a folder"):
        gt.residuals(Motor(), data).save(folder / "saved")
    assert [path.name for path in (folder / "saved").iterdir()] == ["residuals.png"]


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
