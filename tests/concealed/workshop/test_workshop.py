"""Machines of the workshop: their models are their plain equations, their laws do what they say, their cases score."""

from __future__ import annotations

import importlib.util
import json
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from experiments.concealed import generate
from experiments.concealed.workshop import laws
from experiments.concealed.workshop.draw import lose
from experiments.concealed.workshop.integrate import Experiment, simulate
from experiments.concealed.workshop.machines import WORKSHOP
from experiments.concealed.workshop.plant import Channel, Concealed, Drive, Machine, Port, Seen, State
from greybox_torch.data import load_dataset
from greybox_torch.mechanisms.library import LIBRARY

NAMES = set(LIBRARY)
GENERAL = {"unknown"}


def the_model(machine: Machine) -> Any:
    spec = importlib.util.spec_from_file_location(machine.name, machine.model_file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, machine.model)()


@pytest.mark.parametrize("name", WORKSHOP)
def test_the_model_for_the_tool_is_the_machine_s_plain_equations(name: str) -> None:
    machine, rng = WORKSHOP[name], np.random.default_rng(1)
    model = the_model(machine)
    for _ in range(3):
        s = rng.uniform(0.1, 1.0, len(machine.states))
        u = rng.uniform(-1.0, 1.0, len(machine.inputs))
        p = {n: v * rng.uniform(0.8, 1.2) for n, v in machine.truth.items()}
        f = {n: rng.uniform(-1.0, 1.0) for n in machine.ports}

        def named(names: Any, values: Any) -> SimpleNamespace:
            return SimpleNamespace(
                **{n: torch.tensor(float(v), dtype=torch.float64) for n, v in zip(names, values, strict=True)}
            )

        x, q = named(machine.states, s), named(p, p.values())
        given = model.derivative(x, named([c.name for c in machine.inputs], u), q, named(f, f.values()))
        assert [float(given[n]) for n in machine.states] == pytest.approx(machine.rates(list(s), list(u), p, f))
        shown = model.output(x, named([c.name for c in machine.inputs], u), q)
        assert [float(shown[c.name]) for c in machine.outputs] == pytest.approx(machine.show(list(s), p))


@pytest.mark.parametrize("name", WORKSHOP)
def test_what_a_catalogue_says_of_answers_is_there_in_model_and_library(name: str) -> None:
    machine = WORKSHOP[name]
    model = the_model(machine)
    ports = {port.name for port in model.all_ports}
    for entry in machine.catalogue.values():
        for port, mechanism in (*entry.accept, *entry.near):
            assert port in ports
            assert mechanism in NAMES | GENERAL
        assert set(entry.places) <= ports


@pytest.mark.parametrize("name", WORKSHOP)
def test_every_entry_can_be_drawn(name: str) -> None:
    machine, rng = WORKSHOP[name], np.random.default_rng(3)
    moved = rng.uniform(0.1, 1.0, (3, 50, len(machine.states)))
    seen = Seen(machine.truth, moved, np.ones((3, 50, len(machine.inputs))), np.ones((3, 50, len(machine.outputs))))
    for entry in machine.catalogue.values():
        found = entry.draw(rng, seen)
        assert found.laws or found.actuators or found.sensors


class Slider(Machine):
    """A unit mass without friction, pushed by its input."""

    name, model = "slider", "Slider"
    sample_time, samples, substeps = 0.01, 200, 10
    states = ("position", "speed")
    inputs = (Channel("force", "force", "N"),)
    outputs = (Channel("position", "position", "m"),)
    truth = {"m": 1.0}
    ports = {"mass": Port(lambda s, p: s[0], lambda s, p: s[1])}
    catalogue = {}

    def rates(self, s: State, u: Any, p: Any, f: Any) -> list[float]:
        return [s[1], (u[0] + f["mass"]) / p["m"]]

    def show(self, s: State, p: Any) -> list[float]:
        return [s[0]]

    def drive(self, rng: Any, number: int, p: Any) -> Drive:
        return Drive(np.zeros((200, 1)), np.zeros((200, 0)))


def pushed(force: np.ndarray, hidden: Concealed, speed: float = 0.0) -> Experiment:
    """The slider from rest (or from a speed) under a force (samples,)."""
    machine = Slider()
    return simulate(
        machine, machine.truth, machine.drive(None, 0, None), hidden, start=[0.0, speed], resolution=[0.0],
        noise=np.zeros((len(force), 1)), replay=force[:, None],
    )  # fmt: skip


def test_dry_friction_holds_what_is_pushed_less_than_its_level_and_no_more() -> None:
    force = np.where(np.arange(200) < 100, 0.9, 1.5)
    run = pushed(force, Concealed([("mass", laws.coulomb(1.0))]))
    assert np.abs(run.states[:101]).max() < 1e-12
    assert run.states[-1, 1] == pytest.approx(0.5 * 0.99)


def test_a_wall_throws_back_with_its_share_of_the_speed() -> None:
    run = pushed(np.zeros(200), Concealed([("mass", laws.Impact(0.5, 0.4))]), speed=1.0)
    assert run.states[-1, 1] == pytest.approx(-0.4)
    assert run.states[:, 0].max() == pytest.approx(0.5, abs=0.011)


def test_bristles_yield_at_their_level() -> None:
    run = pushed(np.full(200, 2.0), Concealed([("mass", laws.lugre(1.0, 0.0, 1.0, 1e-3))]))
    late = run.states[100:, 1]
    assert np.diff(late) == pytest.approx(0.01, rel=1e-3)  # 2 N less the level of 1 N, on 1 kg


def test_actuators_are_late_slow_and_limited() -> None:
    step = np.where(np.arange(200) < 50, 0.0, 1.0)
    speed = {
        name: pushed(step, Concealed(actuators={"force": {name: value}})).states[-1, 1]
        for name, value in {"delay": 0.1, "lag": 0.1, "limit": 0.5, "dead": 0.2, "gain": 1.1, "bias": 0.01}.items()
    }
    whole = 149 * 0.01
    expected = {
        "delay": whole - 0.1, "lag": whole - 0.1, "limit": 0.5 * whole, "dead": 0.8 * whole, "gain": 1.1 * whole,
        "bias": whole + 199 * 1e-4,
    }  # fmt: skip
    assert speed == pytest.approx(expected, rel=1e-5)


def test_sensors_are_late_and_slow() -> None:
    shown = {
        name: pushed(np.zeros(200), Concealed(sensors={"position": {name: 0.1}}), speed=1.0).outputs[-1, 0]
        for name in ("delay", "lag", "bias")
    }
    assert shown == pytest.approx({"delay": 1.89, "lag": 1.89, "bias": 2.09}, abs=1e-3)


def test_a_case_has_the_files_of_every_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(type(WORKSHOP["pump"]), "samples", 150)
    monkeypatch.setattr(type(WORKSHOP["heater"]), "samples", 150)
    assert generate.main([str(tmp_path), "--family", "workshop", "--cases", "2", "--seed", "3"]) == 0
    keys = [json.loads((tmp_path / f"c{n:03d}" / "key.json").read_text()) for n in (0, 1)]
    assert [key["machine"] for key in keys] == ["pump", "heater"]
    for number in (0, 1):
        folder = tmp_path / f"c{number:03d}"
        card = tomllib.loads((folder / "dataset.toml").read_text())
        assert [e["role"] for e in card["experiment"]] == ["estimation", "validation", "validation"]
        data = load_dataset(folder / "dataset.toml")
        assert len(data.estimation()) == 1


def test_samples_that_are_lost_are_of_one_output() -> None:
    outputs = np.zeros((500, 2))
    lose(np.random.default_rng(0), outputs)
    assert sorted(np.isnan(outputs).sum(axis=0) > 5) == [False, True]
