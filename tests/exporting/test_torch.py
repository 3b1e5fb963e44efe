"""A module of torch that needs nothing of this package and gives what `greybox simulate` gives."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import greybox_torch as gt

Machine = Any  # of conftest.py, which tests cannot import


def module_of(folder: Path, machine: Machine) -> Any:
    (file,) = gt.export(machine.model, to="torch", data=machine.data, step=machine.step, name="my_machine").save(folder)
    spec = importlib.util.spec_from_file_location("my_machine", file)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made.MyMachine()


def driven(machine: Machine) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    time = torch.tensor(machine.data.recordings[0].time)
    return time, torch.tensor(machine.inputs), torch.tensor(machine.start, dtype=torch.float64)


def test_agrees_with_simulate(tmp_path: Path, machine: Machine) -> None:
    made = module_of(tmp_path, machine)
    time, u, x0 = driven(machine)
    with torch.no_grad():
        found = made(time, u, x0)
        assert machine.largest_difference(found.numpy()) < 1e-9
        batch = made(time[:30], torch.stack([u, 0.5 * u])[:, :30], x0.expand(2, -1))
    torch.testing.assert_close(batch[0], found[:30], rtol=1e-12, atol=1e-14)
    assert (batch[1] - batch[0]).abs().max() > 1e-6


def test_inputs_without_a_column_each_are_refused_in_words(tmp_path: Path, machine: Machine) -> None:
    """Seen: "IndexError: too many indices" of a single input with one number for each time."""
    time, u, x0 = driven(machine)
    expected = re.escape(f"u: found the shape ({len(time)},), expected (..., {len(time)}, {u.shape[-1]})")
    with pytest.raises(ValueError, match=expected):
        module_of(tmp_path, machine)(time, u[:, 0], x0)


def test_agrees_on_recordings(tmp_path: Path, recorded: Machine) -> None:
    """On their first part: a step takes a millisecond here."""
    time, u, x0 = (v[:400] if k < 2 else v for k, v in enumerate(driven(recorded)))
    with torch.no_grad():
        assert recorded.largest_difference(module_of(tmp_path, recorded)(time, u, x0).numpy()) < 1e-9


def test_odeint_and_gradients(tmp_path: Path, arm_with_effects: Machine) -> None:
    made = module_of(tmp_path, arm_with_effects)
    time, u, x0 = (v[:12] if k < 2 else v for k, v in enumerate(driven(arm_with_effects)))
    own, adaptive = made(time, u, x0), made(time, u, x0, method="dopri5", rtol=1e-10, atol=1e-12)
    torch.testing.assert_close(own, adaptive, rtol=1e-3, atol=1e-3 * float(own.detach().abs().max()))
    own.square().sum().backward()
    k = [entry["name"] for entry in made.PARAMETERS].index("J")
    slope = float(made.values.grad[k])
    costs = []
    for sign in (1, -1):
        moved = module_of(tmp_path, arm_with_effects)
        with torch.no_grad():
            moved.values[k] += sign * 1e-7
            costs.append(float(moved(time, u, x0).square().sum()))
    assert np.isclose(slope, (costs[0] - costs[1]) / 2e-7, rtol=1e-5)


def test_switches(tmp_path: Path, arm_with_effects: Machine) -> None:
    made = module_of(tmp_path, arm_with_effects)
    time, u, _ = driven(arm_with_effects)
    assert made.EFFECTS == ["gear_spring.backlash", "actuator.input_lag"]
    for effect in made.EFFECTS:
        made.switch(effect, False)
    plain = arm_with_effects.model.plain
    with torch.no_grad():
        found = made(time, u)
        rigid = module_of(tmp_path, replace(arm_with_effects, model=plain))
        rigid.STEP = made.STEP
        torch.testing.assert_close(found, rigid(time, u), rtol=1e-9, atol=1e-12)


def test_it_imports_nothing_of_this_package(tmp_path: Path, arm_with_effects: Machine) -> None:
    module_of(tmp_path, arm_with_effects)
    program = (
        "import sys, my_machine; my_machine.MyMachine(); print([n for n in sys.modules if n.startswith('greybox')])"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
