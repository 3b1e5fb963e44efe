"""Checkpoints of a user's own model, plain, with effects and with a network, on the way back into `compare` and `evaluate`."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner, Result

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.cli import app
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.demo import DATASET
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.stored import attachment_json
from greybox_torch.model import Signals
from greybox_torch.restored import load_beside, load_saved_model
from greybox_torch.systems import load_model
from greybox_torch.training.hybrid import attach_network, make_network

Make = Callable[..., Path]

AROUND = Surroundings({"input": Range(-3.0, 3.0, 1.7)}, {"input": "V"}, "V", 0.01)
UNITS = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}
DEADZONE = attachment_json(Attachment("actuator", ActuatorDeadzone()), AROUND)


def saved(folder: Path, effects: list[dict[str, Any]], **more: float) -> str:
    values = {"J": 0.02, "k": 0.1, "b": 0.05, **more}
    model = f"{folder.resolve()}/my_motor.py:Motor"
    save_checkpoint(
        folder / "model",
        Checkpoint(model, "Motor", values, {**UNITS, **dict.fromkeys(more, "")}, effects, free_starts=True),
    )
    return str(folder / "model")


def compare(folder: Path, checkpoint: str) -> Result:
    arguments = ["compare", str(folder / "dataset.toml"), checkpoint, "--json", "--out", str(folder / "out")]
    return CliRunner().invoke(app, arguments)


def test_the_effect_is_simulated(motor_folder: Make) -> None:
    """With the true dead zone attached nothing but noise is left."""
    folder = motor_folder(dead_zone=0.4)
    result = compare(folder, saved(folder, [DEADZONE], **{"actuator.actuator_deadzone.half_width": 0.4}))
    assert result.exit_code == 0, result.stderr
    start, restored = json.loads(result.stdout)["models"]
    for before, after in zip(start["fit"], restored["fit"], strict=True):
        assert after["rmse"] == pytest.approx(0.02, rel=0.15)
        assert before["rmse"] > 5 * after["rmse"]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"port": "rotary"}, ["no port 'rotary'", "rotor, actuator, sensor"]),
        ({"mechanism": "stiction"}, ["mechanism 'stiction' is not in the library", "coulomb_friction"]),
        (
            {"options": {"order": 2}},
            ['"effects" are damaged', "ActuatorDeadzone", "unexpected keyword argument 'order'"],
        ),
        ({"surroundings": {}}, ['"effects" are damaged', "ranges"]),
    ],
)
def test_effects_that_cannot_be_attached(motor_folder: Make, change: dict[str, Any], expected: list[str]) -> None:
    folder = motor_folder()
    path = saved(folder, [{**DEADZONE, **change}], **{"actuator.actuator_deadzone.half_width": 0.4})
    result = compare(folder, path)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: checkpoint {path}: ")
    for text in expected:
        assert text in result.stderr
    assert result.stdout == ""


def test_values_of_another_effect(motor_folder: Make) -> None:
    folder = motor_folder()
    result = compare(folder, saved(folder, [DEADZONE], **{"rotor.coulomb_friction.F_c": 0.4}))
    assert result.exit_code == 2
    assert "it lacks actuator.actuator_deadzone.half_width; it has rotor.coulomb_friction.F_c" in result.stderr


def plain(folder: Path, **changes: Any) -> Checkpoint:
    model = f"{folder.resolve()}/my_motor.py:Motor"
    return replace(Checkpoint(model, "Motor", {"J": 0.02, "k": 0.1, "b": 0.05}, UNITS), **changes)


def test_units_of_a_model_that_has_changed(motor_folder: Make) -> None:
    folder = motor_folder()
    save_checkpoint(folder / "model", plain(folder, units={**UNITS, "b": "N m min"}))
    result = compare(folder, str(folder / "model"))
    assert result.exit_code == 2
    assert 'b is in "N m min", expected "N m s/rad" as model Motor has it' in result.stderr


def test_values_that_break_a_constraint(motor_folder: Make) -> None:
    folder = motor_folder()
    model = load_model("robot_arm")
    units = {p.name: p.unit for p in model.declared_parameters}
    save_checkpoint(
        folder / "arm", Checkpoint("robot_arm", "robot_arm", {**model.values(), "a_m": 0.5, "a_g": 0.5}, units)
    )
    with pytest.raises(UserError, match=r"checkpoint .*arm: its values break a constraint of model robot_arm"):
        load_beside(folder / "arm", model, load_dataset(DATASET))


@given(
    net=st.sampled_from(["friction", "residual"]),
    units=st.integers(1, 5),
    seed=st.integers(0, 99),
    options=st.sampled_from([{}, {"odd": False}, {"dissipative": False}]),
    size=st.floats(1e-3, 10.0),
)
@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_networks_come_back_as_they_were(
    own_motor: tuple[DataSet, Problem], net: str, units: int, seed: int, options: dict[str, bool], size: float
) -> None:
    """A user's own model with a network of any weights: the same parameters, and the same rates of change to the last digit."""
    data, base = own_motor
    network = make_network(
        net, base.model.ports[0], (), units=units, seed=seed, **(options if net == "friction" else {})
    )
    around = {"rotor": Surroundings({"speed": Range(-6.0, 5.0, 3.0)}, {"speed": "rad/s"}, "N m", 0.01)}
    hybrid = attach_network(base, "rotor", network, around)
    drawn = size * np.random.default_rng(seed).uniform(0.1, 1.0, len(hybrid.problem.values))
    values = np.where(hybrid.heights, drawn, hybrid.problem.values)
    problem = hybrid.problem.with_values(values)
    checkpoint = Checkpoint(
        model=str(data.model),
        title="Motor",
        values=dict(zip(problem.names, values.tolist(), strict=True)),
        units={p.name: p.unit for p in problem.model.declared_parameters},
        effects=[attachment_json(a, hybrid.surroundings[a.port]) for a in hybrid.attachments],
        free_starts=True,
    )
    save_checkpoint(data.path.parent / "hybrid", checkpoint)
    loaded, data = load_beside(data.path.parent / "hybrid", base.model, data)
    found = make_problem(data, loaded, data.recordings)
    assert found.names == problem.names
    assert np.array_equal(found.values, values)
    x, u = torch.linspace(-6, 6, 25, dtype=torch.float64)[None], torch.zeros(1, 25, dtype=torch.float64)
    p = Signals("parameter", dict(zip(found.names, torch.as_tensor(values), strict=True)))
    with torch.no_grad():
        rates = [own.model.rates(x, u, p) for own in (problem, found, base)]
    assert torch.equal(rates[0], rates[1])
    assert not torch.allclose(
        rates[0], rates[2], rtol=1e-3 * min(1.0, size), atol=0.0
    )  # small weights move them little


@pytest.fixture
def own_motor(motor_folder: Make) -> tuple[DataSet, Problem]:
    data = load_dataset(motor_folder() / "dataset.toml")
    return data, make_problem(data, load_model(str(data.model)), data.estimation())


EVIL = "from pathlib import Path\nPath(__file__).with_name('ran').touch()\n"


@pytest.mark.parametrize("place", ["evil.py", "../elsewhere/evil.py"])
@pytest.mark.parametrize("title", ["Motor", "Evil"])
def test_a_model_file_that_only_the_checkpoint_names_never_runs(motor_folder: Make, place: str, title: str) -> None:
    folder = motor_folder()
    (folder.parent / "elsewhere").mkdir()
    evil = folder / place
    evil.write_text(EVIL + (folder / "my_motor.py").read_text())
    save_checkpoint(folder / "model", plain(folder, model=f"{evil}:Motor", title=title))
    result = compare(folder, str(folder / "model"))
    if title == "Motor":  # the user's own model stands in, whose parameters are those of the checkpoint
        assert result.exit_code == 0, result.stderr
    else:
        assert result.exit_code == 2
        assert (
            "expected a checkpoint of Motor, or Evil as the model that is named: on the card, as --model"
            in result.stderr
        )
    with pytest.raises(UserError, match="a model file is run only where you name it yourself") as refused:
        load_saved_model(folder / "model")
    assert f"load('{folder / 'model'}', model=" in str(refused.value), "the call to write instead"
    assert not evil.with_name("ran").exists()
    assert load_saved_model(folder / "model", f"{folder}/my_motor.py:Motor").checkpoint.title == title


def test_values_outside_the_bounds_are_refused(motor_folder: Make) -> None:
    folder = motor_folder()
    save_checkpoint(folder / "model", plain(folder, values={"J": -0.02, "k": 0.1, "b": 0.05}))
    result = compare(folder, str(folder / "model"))
    assert result.exit_code == 2
    assert "J is -0.02, outside its bounds [0, inf] in model Motor" in result.stderr
