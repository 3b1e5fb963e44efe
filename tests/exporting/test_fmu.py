"""FMUs that an independent client finds valid and simulates as `greybox simulate` does."""

from __future__ import annotations

import io
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed (extra [fmu])")
Machine = Any  # of conftest.py, which tests cannot import

EDITIONS = [2, 3]


@pytest.fixture(scope="module")
def fmus(arm_with_effects: Machine, tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """The FMUs of the arm, by edition."""
    return fmus_of(arm_with_effects, tmp_path_factory.mktemp("fmu"))


def fmus_of(machine: Machine, folder: Path) -> dict[int, Path]:
    made = gt.export(machine.model, to="fmu", data=machine.data, name="machine").save(folder)
    return dict(zip(EDITIONS, made, strict=True))


def outputs_of(file: Path, machine: Machine, **values: Any) -> np.ndarray:
    """Outputs (n, n_y) by FMPy, which holds inputs over a step."""
    recording = machine.data.recordings[0]
    inputs = [i.name for i in machine.model.plain.inputs]
    kinds = [("time", float), *((name, float) for name in inputs)]
    table = np.array(list(zip(recording.time, *machine.inputs.T, strict=True)), dtype=kinds)
    states = {f"state.{name}": value for name, value in machine.simulated.run.initial["steps"].items()}
    found = fmpy.simulate_fmu(
        str(file),
        start_time=recording.time[0],
        stop_time=recording.time[-1],
        step_size=recording.sample_time,
        output_interval=recording.sample_time,
        input=table,
        start_values={**states, **values},
        output=[o.name for o in machine.model.outputs],
        fmi_type="CoSimulation",
    )
    return np.column_stack([found[o.name] for o in machine.model.outputs])


@pytest.mark.parametrize("edition", EDITIONS)
def test_valid(fmus: dict[int, Path], edition: int) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(fmus[edition])) == []


@pytest.mark.parametrize("edition", EDITIONS)
def test_agrees_with_simulate(fmus: dict[int, Path], arm_with_effects: Machine, edition: int) -> None:
    assert arm_with_effects.largest_difference(outputs_of(fmus[edition], arm_with_effects)) < 1e-9


@pytest.mark.parametrize("edition", EDITIONS)
def test_effects_are_switched_and_parameters_tuned(
    fmus: dict[int, Path], arm_with_effects: Machine, edition: int
) -> None:
    whole = outputs_of(fmus[edition], arm_with_effects)
    off = {"gear_spring.backlash.active": False, "actuator.input_lag.active": False}
    rigid = outputs_of(fmus[edition], arm_with_effects, **off)
    none = outputs_of(fmus[edition], arm_with_effects, **{**off, "gear_spring.backlash.half_gap": 0.5})
    assert np.abs(rigid - whole).max() > 1e-3
    np.testing.assert_allclose(none, rigid, rtol=1e-12, atol=1e-12)  # a gap that does not act may be of any size
    heavy = outputs_of(fmus[edition], arm_with_effects, J=0.1)
    assert np.abs(heavy - whole).max() > 1e-3


@pytest.mark.parametrize("edition", EDITIONS)
def test_what_a_user_sees(fmus: dict[int, Path], edition: int) -> None:
    described = fmpy.read_model_description(fmus[edition])
    seen = {v.name: v for v in described.modelVariables}
    assert (seen["J"].causality, seen["J"].variability, seen["J"].unit) == ("parameter", "tunable", "kg m^2")
    assert seen["J"].description == "total moment of inertia"
    assert float(seen["gear_spring.backlash.half_gap"].start) == 0.03
    assert (seen["gear_spring.backlash.active"].type, seen["gear_spring.backlash.active"].start) == ("Boolean", "true")
    assert (seen["state.gear_twist"].causality, seen["state.gear_twist"].unit) == ("local", "rad")
    assert (seen["motor_speed"].causality, seen["torque"].causality) == ("output", "input")


@pytest.mark.parametrize("edition", EDITIONS)
def test_the_sources_are_in_it(fmus: dict[int, Path], edition: int) -> None:
    with zipfile.ZipFile(io.BytesIO(fmus[edition].read_bytes())) as archive:
        names = archive.namelist()
    assert {"sources/machine.c", "sources/machine.h", "sources/instance.h", f"sources/fmi{edition}.c"} <= set(names)
    assert any(name.startswith("binaries/") for name in names)


@pytest.mark.parametrize("edition", EDITIONS)
def test_the_sources_compile_without_a_warning(fmus: dict[int, Path], edition: int, tmp_path: Path) -> None:
    with zipfile.ZipFile(fmus[edition]) as archive:
        archive.extractall(tmp_path)
    flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-fPIC", "-shared"]
    command = ["gcc", *flags, "machine.c", f"fmi{edition}.c", "-lm", "-o", "machine.so"]
    done = subprocess.run(command, cwd=tmp_path / "sources", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_other_machines_agree(machine: Machine, tmp_path: Path) -> None:
    if machine.data.hold != "zoh":
        pytest.skip("FMUs hold their inputs over a step; this machine's inputs run on straight lines")
    for file in fmus_of(machine, tmp_path).values():
        assert machine.largest_difference(outputs_of(file, machine)) < 1e-9


def test_without_a_compiler(arm_with_effects: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("greybox_torch.exporting.fmu.shutil.which", lambda name: None)
    with pytest.raises(gt.UserError, match="no C compiler is here"):
        gt.export(arm_with_effects.model, to="fmu", step=5e-4)
