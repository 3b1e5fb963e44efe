"""Every law of the library, and every learned one, in C and in torch: its switch on, the model's own numbers; off, the plain ones."""

from __future__ import annotations

import ctypes
import importlib.util
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.exporting.exported import ExportedModel
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.library import LEARNED, LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.model import GreyBoxModel, Signals

SIGNALS = ("speed", "position", "load", "time", "deflection", "rate", "level", "input", "output")
AROUND = Surroundings(dict.fromkeys(SIGNALS, Range(-1.0, 1.0, 0.5)), dict.fromkeys(SIGNALS, "1"), "N m", 5e-3)
SIGNAL = {"body": "speed", "coupling": "deflection", "balance": "level", "actuator": "input", "sensor": "output"}


def mechanisms(kind: str) -> list[Mechanism]:
    """One of each that fits a port of that kind."""
    laws = [law() for law in LIBRARY.values() if kind in law.kinds]
    of = SIGNAL[kind]
    learned = {
        "unknown": {"signal": of},
        "unknown_with_memory": {"signal": of},
        "unknown_fading": {"signal": of},
        "unknown_map": {},
        "unknown_play": {},
        "unknown_rate_limit": {},
        "friction_net": {},
        "residual_net": {"inputs": (of,)},
        "memory_net": {"inputs": (of,)},
    }
    return [*laws, *(made(**learned[name]) for name, made in LEARNED.items() if kind in made.kinds)]  # type: ignore[arg-type]


def with_everything(model: GreyBoxModel, ports: dict[str, str]) -> AugmentedModel:
    """All mechanisms of the kinds of ``ports``, with numbers that let every one of them act."""
    shifted = {"gear_spring": "+gear_twist"}
    attached = [
        attach(model, port, mechanism, shifted.get(port, "") if mechanism.kinematic else "")
        for port, kind in ports.items()
        for mechanism in mechanisms(kind)
    ]
    made = AugmentedModel(model, attached, dict.fromkeys(ports, AROUND))
    draw = np.random.default_rng(2)
    for p in made.declared_parameters:
        low, high = p.bounds
        if "." in p.name and not p.fixed:
            made.set_values({p.name: float(np.clip(p.value + 0.1 * draw.uniform(0.2, 1.0), low, high))})
    return made


CASES = {
    "body": ("robot_arm", {"arm": "body"}),
    "coupling": ("robot_arm", {"gear_spring": "coupling"}),
    "drive and sensor": ("robot_arm", {"actuator": "actuator", "sensor": "sensor"}),
    "balance": ("small.py:Tank", {"tank": "balance"}),
}


@pytest.fixture(params=list(CASES))
def model(request: pytest.FixtureRequest, machines: Path) -> AugmentedModel:
    name, ports = CASES[request.param]
    return with_everything(gt.load_model(str(machines / name) if ".py" in name else name), ports)


def test_every_mechanism_is_tried() -> None:
    tried = {m.name for _, ports in CASES.values() for kind in ports.values() for m in mechanisms(kind)}
    assert tried == {*LIBRARY, *LEARNED}


def test_in_c(model: AugmentedModel, tmp_path: Path) -> None:
    compiler = shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no C compiler")
    made = gt.export(model, to="c", name="machine")
    made.save(tmp_path)
    flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O0", "-shared", "-fPIC"]
    done = subprocess.run(
        [compiler, *flags, "machine.c", "-lm", "-o", "machine.so"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    library = ctypes.CDLL(str(tmp_path / "machine.so"))

    def evaluated(x: np.ndarray, u: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        results = [np.zeros(len(model.states)), np.zeros(len(model.outputs))]
        for function, found in zip((library.machine_rates, library.machine_outputs), results, strict=True):
            function(*(v.ctypes.data_as(ctypes.c_void_p) for v in (x, u, p, found)))
        return results

    check(model, made.exported, evaluated)


def test_in_torch(model: AugmentedModel, tmp_path: Path) -> None:
    made = gt.export(model, to="torch", name="machine")
    (file,) = made.save(tmp_path)
    spec = importlib.util.spec_from_file_location("machine", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    machine = module.Machine()
    switches = np.array([p.is_switch for p in made.exported.parameters])

    def evaluated(x: np.ndarray, u: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        machine.active[:] = torch.tensor(p[switches])
        state, given = torch.tensor(x), torch.tensor(u)
        with torch.no_grad():
            return [machine.rates(state, given).numpy(), machine.outputs(state, given).numpy()]

    check(model, made.exported, evaluated)


def check(model: AugmentedModel, exported: ExportedModel, evaluated: Any) -> None:
    """At a few points: the model's own rates and outputs, and without effects those of the plain model."""
    draw = np.random.default_rng(4)
    plain, delays = model.plain, exported.delays
    states, inputs = len(plain.states), len(plain.inputs)
    on = np.array([p.value for p in exported.parameters])
    off = np.where([p.is_switch for p in exported.parameters], 0.0, on)
    for _ in range(4):
        x, u = 0.3 * draw.normal(size=len(model.states)), draw.normal(size=inputs + len(delays))
        given = [*u[:inputs]]
        for k, delay in enumerate(delays):
            given += [u[inputs + k], 7.0, on[delay.parameter]]  # value, slope and delay at which the value was taken
        for found, own in zip(evaluated(x, u, on), numbers(model, x, given), strict=True):
            np.testing.assert_allclose(found, own, rtol=1e-9, atol=1e-12 * np.abs(own).max())
        for found, own in zip(evaluated(x, u, off), numbers(plain, x[:states], u[:inputs]), strict=True):
            np.testing.assert_allclose(found[: len(own)], own, rtol=1e-9, atol=1e-12 * np.abs(own).max())


def numbers(model: GreyBoxModel, x: Any, u: Any) -> list[np.ndarray]:
    """Rates and outputs of a model with the values that it holds."""
    held, tensor = model.values(), lambda v: torch.tensor(float(v), dtype=torch.float64)
    p = Signals("parameter", {name: tensor(held[name]) for name in (q.name for q in model.declared_parameters)})
    state = torch.tensor(np.asarray(x), dtype=torch.float64)
    given = torch.tensor(np.asarray(u), dtype=torch.float64)
    with torch.no_grad():
        return [np.asarray(function(state, given, p)) for function in (model.rates, model.measured)]
