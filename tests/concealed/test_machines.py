"""The machines of the proof, their catalogues, and how visible their effects are made."""

from __future__ import annotations

import ast
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.concealed import scaling, visibility
from experiments.concealed.machines import MACHINES
from experiments.concealed.machines.arm import Arm
from experiments.concealed.machines.pendulum import Pendulum
from experiments.concealed.machines.stage import Stage
from experiments.concealed.scaling import calibrate
from experiments.concealed.trial_files import card_text, digest, key, write
from experiments.concealed.visibility import residuals, unexplained, word
from tests.concealed.test_effects import ACTUATOR, BODY, COUPLING, SENSOR

ROOT = Path(__file__).parents[2]


class ShortArm(Arm):
    samples = 700
    pre_roll = 1.0


class ShortStage(Stage):
    samples = 900
    pre_roll = 0.2


class ShortPendulum(Pendulum):
    samples = 700
    pre_roll = 0.2


def mechanisms(machine: str, port: str) -> set[str]:
    kind = port.partition(".")[0]
    if kind in ("actuator", "sensor"):
        return ACTUATOR | {"torque_ripple"} if kind == "actuator" else SENSOR
    return COUPLING if port.endswith(("_spring", "shaft")) else BODY


@pytest.mark.parametrize("machine", MACHINES)
def test_answers_are_in_the_contract_and_at_ports_of_the_model(machine: str):
    from greybox_torch.systems.load import load_model

    m = MACHINES[machine]
    spec = m.model if m.model_file is None else f"{m.model_file}:{m.model.partition(':')[2]}"
    ports = {port.name for port in load_model(spec).all_ports}
    for effect in m.catalogue.values():
        assert effect.accept
        for port, name in (*effect.accept, *effect.near, *effect.alone):
            assert port in ports, (machine, effect.name)
            assert name == "unknown" or name in mechanisms(machine, port), (machine, effect.name)
        assert not set(effect.accept) & set(effect.near)
        assert {port for port, _ in effect.accept} & set(effect.ports)
        assert set(effect.ports) <= ports


@pytest.mark.parametrize("machine", MACHINES)
def test_nominal_model_names_the_channels_and_parameters_of_the_card(machine: str):
    from greybox_torch.systems.load import load_model

    m = MACHINES[machine]
    model = load_model(m.model if m.model_file is None else f"{m.model_file}:{m.model.partition(':')[2]}")
    assert [(i.name, i.unit) for i in model.inputs] == [(c.name, c.unit) for c in m.inputs]
    assert [(o.name, o.unit) for o in model.outputs] == [(c.name, c.unit) for c in m.outputs]
    assert {p.name for p in model.declared_parameters} == set(m.parameters)


def test_generator_never_imports_its_nominal_models():
    for file in (ROOT / "experiments" / "concealed").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [name for name in names if "concealed.nominal" in name], file


@pytest.mark.parametrize("machine", [ShortStage(), ShortPendulum(), ShortArm()], ids=lambda m: m.name)
def test_without_effect_the_true_model_leaves_the_floor_and_a_weak_one_is_as_visible_as_was_asked(machine):
    effect = "constant_bias"
    trials = [
        machine.draw(3, 0, ()),
        machine.draw(3, 1, (effect,), targets=(3.0,)),
        machine.draw(3, 2, (effect,), targets=(8.0,)),
    ]
    runs = calibrate(machine, trials)
    noise = {"stage": (2e-5,), "pendulum": (1e-3, 0.02), "arm": (0.05,)}[machine.name]
    assert trials[0].visibility < 0.5
    for trial in trials:
        for floor, sigma, sensor in zip(trial.floor, trial.sigma, noise, strict=True):
            assert 0.8 * sensor < floor < 4.0 * sensor
            assert sigma > 0.9 * floor  # a tenth of so short a recording says little of the start: no upper bound here
    assert trials[1].visibility == pytest.approx(3.0, rel=0.3)
    assert trials[2].visibility == pytest.approx(8.0, rel=0.3)
    assert (word(trials[1].visibility), word(trials[2].visibility)) == ("weak", "moderate")
    assert [run.outputs.shape for run in runs] == [(len(noise), machine.before + machine.samples, 4)] * 3


def test_projection_takes_up_what_parameters_and_start_states_explain():
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(3, 1, 50, 4))
    shared, own = 0.7, np.array([1.0, -2.0, 0.5, 3.0])
    explained = shared * columns[0] + own * columns[1]
    wide = np.repeat(explained, 4, axis=1)  # every fourth sample is looked at
    assert np.abs(unexplained(wide, columns, 1, np.ones(1))).max() < 1e-9
    odd = np.repeat(rng.normal(size=(1, 50, 4)), 4, axis=1)
    np.testing.assert_allclose(
        unexplained(wide + odd, columns, 1, np.ones(1)), unexplained(odd, columns, 1, np.ones(1)), atol=1e-9
    )


def test_start_states_are_fitted_on_the_first_tenth_alone():
    rng = np.random.default_rng(1)
    states = rng.normal(size=(2, 1, 100, 4))
    exact = 0.3 * states[0] - 2.0 * states[1]
    later = np.zeros((1, 100, 4))
    later[:, 10:] = 1.0
    left = visibility.free_run(np.repeat(exact + later, 4, axis=1), states, np.ones(1))
    np.testing.assert_allclose(left, later, atol=1e-9)


def test_replay_on_true_parameters_leaves_no_more_than_noise():
    machine = ShortStage()
    trials = [machine.draw(5, i, ()) for i in range(2)]
    left = residuals(machine, trials, machine.run(trials))
    assert len(left) == 2
    assert max(np.abs(each).max() for each in left) < 1e-3  # m, on a travel of 0.1


def test_shapes_of_an_effect_do_not_depend_on_its_strength():
    machine = ShortPendulum()
    weak, strong = machine.draw(1, 4, ("ripple",)), machine.draw(1, 4, ("ripple",))
    plain = machine.run([weak], effects=False)[0]
    weak.scales, strong.scales = [0.2], [2.0]
    for trial in (weak, strong):
        trial.draw_switches(plain)
    assert strong.switches[0]["amplitude"] == pytest.approx(10.0 * weak.switches[0]["amplitude"])
    assert (weak.switches[0]["order"], weak.switches[0]["phase"]) == (
        strong.switches[0]["order"],
        strong.switches[0]["phase"],
    )


def test_folder_of_a_trial_holds_what_the_tool_may_know_and_no_key(tmp_path: Path):
    machine = ShortPendulum()
    trial = machine.draw(2, 0, ("coulomb",), estimation="validation2")
    plain = machine.run([trial], effects=False)[0]
    trial.draw_switches(plain)
    trial.sigma, trial.visibility = (0.001, 0.02), 7.0
    write(tmp_path / "c000", trial, machine.run([trial])[0])
    assert {f.name for f in (tmp_path / "c000").iterdir()} == {
        "dataset.toml",
        "model.py",
        *(f"experiment{i}.csv" for i in (1, 2, 3, 4)),
    }
    card = tomllib.loads(card_text(trial))
    assert [e["role"] for e in card["experiment"]] == ["validation", "validation", "estimation", "validation"]
    assert card["model"]["parameters"]["mgl"]["fixed"] is True
    assert "coulomb" not in "".join(f.read_text() for f in (tmp_path / "c000").iterdir()).lower()
    table = np.loadtxt(tmp_path / "c000" / "experiment1.csv", delimiter=",", skiprows=1)
    assert table.shape == (machine.samples, 3)
    before = digest(tmp_path / "c000")
    (tmp_path / "c000" / "key.json").write_text("{}")
    assert digest(tmp_path / "c000") == before  # the key joins the data once the seal is open
    (tmp_path / "c000" / "experiment1.csv").write_text("x")
    assert digest(tmp_path / "c000") != before
    answer = key(trial)
    assert answer["sigma"] == {"angle": 0.001, "speed": 0.02}
    assert (answer["strength"], answer["effects"]) == ("moderate", ["coulomb"])


def test_twins_that_are_twins_alone_are_near_beside_another_effect():
    machine = ShortStage()
    single, pair = machine.draw(1, 0, ("input_lag",)), machine.draw(1, 0, ("input_lag", "coulomb"))
    for trial in (single, pair):
        trial.draw_switches(machine.run([trial], effects=False)[0])
        trial.sigma = (1.0,)
    assert key(single)["accept"][0] == [["actuator", "input_lag"], ["sensor", "sensor_lag"]]
    assert key(pair)["accept"][0] == [["actuator", "input_lag"]]
    assert ["sensor", "sensor_lag"] in key(pair)["near"][0]
    assert key(single)["own"] == [["actuator", "input_lag"]], "what was concealed, of the names that are right"
    assert key(pair)["own"] == [["actuator", "input_lag"], ["carriage", "coulomb_friction"]]


@pytest.mark.parametrize("name", ["pendulum", "engine_pendulum"])
def test_a_pendulums_gain_is_another_weight_where_nothing_else_is_concealed(name: str):
    """Divided by the gain, the equation of motion has other values of what is free, and another weight; so either name is right."""
    machine, gain = MACHINES[name], 1.2
    assert ("pivot", "gravity") in machine.catalogue["input_gain"].alone and "mgl" not in machine.free
    truth = {n: np.full(1, 0.3) for n in machine.parameters} | {"mgl": np.full(1, 2.0)}
    torque = np.sin(np.linspace(0.0, 20.0, 500))[:, None]
    divided = {n: v if n in ("length", "rod") else v / gain for n, v in truth.items()}
    start = np.zeros((2, 1))
    driven, lighter = machine.replay(truth, start, gain * torque), machine.replay(divided, start, torque)
    np.testing.assert_allclose(driven, lighter, atol=1e-9)
    assert np.abs(driven - machine.replay(truth, start, torque)).max() > 0.01


def test_effects_that_overflow_are_halved_until_they_do_not(monkeypatch: pytest.MonkeyPatch):
    machine = ShortStage()
    trial = machine.draw(4, 0, ("constant_bias",))
    plain = machine.run([trial], effects=False)
    ran = machine.run

    def overflowing(trials, **options):
        runs = ran(trials, **options)
        if trials[0].scales[0] > 0.3:
            runs[0].outputs[:] = np.nan
        return runs

    monkeypatch.setattr(machine, "run", overflowing)
    runs = scaling._finite_runs(machine, [trial], plain)
    assert trial.scales == [0.25]
    assert np.isfinite(runs[0].outputs).all()
    monkeypatch.setattr(machine, "run", lambda trials, **_: [replace(plain[0], outputs=np.full((1, 3, 4), np.nan))])
    with pytest.raises(FloatingPointError, match="stage with constant_bias"):
        scaling._finite_runs(machine, [trial], plain)
