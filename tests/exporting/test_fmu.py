"""FMUs that an independent client finds valid and simulates as `greybox simulate` does."""

from __future__ import annotations

import ctypes
import io
import shutil
import subprocess
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed (extra [fmu])")
Machine = Any  # of conftest.py, which tests cannot import
Made = Callable[[str], Machine]

EDITIONS = [2, 3]


@pytest.fixture(scope="module")
def fmus(arm_with_effects: Machine, tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """The FMUs of the arm, by edition."""
    return fmus_of(arm_with_effects, tmp_path_factory.mktemp("fmu"))


def fmus_of(machine: Machine, folder: Path) -> dict[int, Path]:
    made = gt.export(machine.model, to="fmu", data=machine.data, step=machine.step, name="machine").save(folder)
    return dict(zip(EDITIONS, made, strict=True))


def outputs_of(file: Path, machine: Machine, **values: Any) -> np.ndarray:
    """Outputs (n, n_y) by FMPy, which holds inputs over a step, or lets them run at the rates that it is told."""
    recording = machine.data.recordings[0]
    inputs = [i.name for i in machine.model.plain.inputs]
    columns = dict(zip(inputs, machine.inputs.T, strict=True))
    if machine.data.hold == "foh":
        step = np.diff(recording.time)
        columns |= {f"{n}.rate": np.append(np.diff(columns[n]) / step, 0.0) for n in inputs}
    kinds = [("time", float), *((name, float) for name in columns)]
    table = np.array(list(zip(recording.time, *columns.values(), strict=True)), dtype=kinds)
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
    from fmpy.validation import validate_fmu

    for file in fmus_of(machine, tmp_path).values():
        assert validate_fmu(str(file)) == []
        assert machine.largest_difference(outputs_of(file, machine)) < 1e-9


@contextmanager
def started(file: Path) -> Iterator[tuple[Any, dict[str, int]]]:
    """An instance in its first step, and the value references by name."""
    described, folder = fmpy.read_model_description(file), fmpy.extract(file)
    kind = fmpy.fmi2.FMU2Slave if described.fmiVersion == "2.0" else fmpy.fmi3.FMU3Slave
    identifier = described.coSimulation.modelIdentifier
    fmu = kind(guid=described.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="one")
    fmu.instantiate()
    if described.fmiVersion == "2.0":
        fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    try:
        yield fmu, {v.name: v.valueReference for v in described.modelVariables}
    finally:
        fmu.terminate()
        fmu.freeInstance()
        shutil.rmtree(folder)


def test_agrees_on_recordings(recorded: Machine, tmp_path: Path) -> None:
    """At the times of the samples, which FMPy's own loop does not take; the first 5000 of them."""
    recording = recorded.data.recordings[0]
    for edition, file in fmus_of(recorded, tmp_path).items():
        with started(file) as (fmu, places):
            put, got = (fmu.setReal, fmu.getReal) if edition == 2 else (fmu.setFloat64, fmu.getFloat64)
            states = [places[f"state.{s.name}"] for s in recorded.model.states]
            inputs = [places[i.name] for i in recorded.model.plain.inputs]
            outputs = [places[o.name] for o in recorded.model.outputs]
            put(states, recorded.start)
            found = []
            for k, u in enumerate(recorded.inputs[:5000].tolist()):
                put(inputs, u)
                found.append(got(outputs))
                if k + 1 < len(recording.time):
                    fmu.doStep(recording.time[k], recording.time[k + 1] - recording.time[k])
        assert recorded.largest_difference(np.array(found)) < 1e-9


@pytest.mark.parametrize("edition", EDITIONS)
def test_going_back_to_a_state_brings_the_past_back(made: Made, tmp_path: Path, edition: int) -> None:
    machine = made("arm with a delay")
    dt = machine.data.recordings[0].sample_time
    with started(fmus_of(machine, tmp_path)[edition]) as (fmu, places):
        put, got = (fmu.setReal, fmu.getReal) if edition == 2 else (fmu.setFloat64, fmu.getFloat64)
        save, back = (fmu.getFMUstate, fmu.setFMUstate) if edition == 2 else (fmu.getFMUState, fmu.setFMUState)

        def run(begin: int, end: int) -> list[float]:
            speeds = []
            for k in range(begin, end):
                put([places["torque"]], [float(k % 5)])
                fmu.doStep(k * dt, dt)
                speeds += got([places["motor_speed"]])
            return speeds

        run(0, 3100)  # more than is kept
        state = save()
        first = run(3100, 3120)
        back(state)
        assert run(3100, 3120) == first


def test_derivatives_of_inputs_by_fmi_2(made: Made, tmp_path: Path) -> None:
    """They do what the rates do, which both editions have."""
    machine = made("double pendulum with friction and delays")
    found = []
    for by_rate in (True, False):
        with started(fmus_of(machine, tmp_path)[2]) as (fmu, places):
            inputs = [places["tau1"], places["tau2"]]
            for k in range(30):
                fmu.setReal(inputs, [0.02 * k, 0.1])
                if by_rate:
                    fmu.setReal([places["tau1.rate"]], [2.0])
                else:
                    orders = (ctypes.c_int * 2)(1, 1)
                    slopes = (ctypes.c_double * 2)(2.0, 0.0)
                    fmu.fmi2SetRealInputDerivatives(fmu.component, (ctypes.c_uint * 2)(*inputs), 2, orders, slopes)
                fmu.doStep(0.01 * k, 0.01)
            found.append(fmu.getReal([places["q1"], places["q2"]]))
    assert found[0] == found[1]
    assert abs(found[0][0]) > 1e-3


def test_without_a_compiler(arm_with_effects: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("greybox_torch.exporting.fmu.shutil.which", lambda name: None)
    with pytest.raises(gt.UserError, match="no C compiler is here"):
        gt.export(arm_with_effects.model, to="fmu", step=5e-4)
