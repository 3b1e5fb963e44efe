"""C that compiles without a warning and gives what `greybox simulate` gives."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt

Machine = Any  # of conftest.py, which tests cannot import

COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
FLAGS = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O2"]


def example(folder: Path, machine: Machine, compiler: str, name: str = "machine", step: float | None = None) -> Path:
    gt.export(machine.model, to="c", data=machine.data, step=step or machine.step, name=name).save(folder)
    sources = [f"{name}.c", "example.c"]
    done = subprocess.run(
        [compiler, *FLAGS, *sources, "-lm", "-o", "example"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return folder / "example"


def outputs_of(program: Path, machine: Machine, begun: float = 0.0) -> np.ndarray:
    """Outputs (n, n_y) of the example over the recorded inputs, with time stamps from ``begun`` on."""
    rows = np.column_stack([begun + machine.data.recordings[0].time, machine.inputs])
    given = "\n".join(",".join(repr(float(v)) for v in row) for row in rows)
    start = [repr(float(v)) for v in machine.start]
    done = subprocess.run([program, *start], input=given, capture_output=True, text=True, check=True)
    found = np.array([[float(cell) for cell in line.split(",")] for line in done.stdout.splitlines()])
    np.testing.assert_array_equal(found[:, 0], rows[:, 0])
    return found[:, 1:]


@pytest.mark.skipif(not COMPILERS, reason="no C compiler")
def test_agrees_on_recordings(tmp_path: Path, recorded: Machine) -> None:
    assert recorded.largest_difference(outputs_of(example(tmp_path, recorded, COMPILERS[0]), recorded)) < 1e-9


@pytest.mark.skipif(not COMPILERS, reason="no C compiler")
def test_agrees_with_simulate(tmp_path: Path, machine: Machine) -> None:
    for compiler in COMPILERS:
        assert machine.largest_difference(outputs_of(example(tmp_path, machine, compiler), machine)) < 1e-9


@pytest.mark.skipif(not COMPILERS, reason="no C compiler")
def test_rounded_time_stamps_take_no_further_steps(tmp_path: Path, made: Callable[[str], Machine]) -> None:
    """Seconds since 1970 are rounded to 0.24 microseconds: half of the intervals took two steps where `greybox simulate` takes one."""
    machine = made("motor with a large step")
    program = example(tmp_path, machine, COMPILERS[0], step=0.02)
    even, rounded = (outputs_of(program, machine, begun) for begun in (0.0, 1772442000.0))
    assert np.abs(rounded - even).max() < 1e-5 * np.abs(even).max()


@pytest.mark.skipif(not COMPILERS, reason="no C compiler")
def test_names_in_the_first_line_and_what_is_no_number(tmp_path: Path, machines: Path) -> None:
    """Seen: no output, no message, and the exit code 0 of a table with names over its columns."""
    gt.export(gt.load_model(f"{machines / 'motor.py'}:Motor"), to="c", name="motor").save(tmp_path)
    command = [COMPILERS[0], *FLAGS, "motor.c", "example.c", "-lm", "-o", "example"]
    subprocess.run(command, cwd=tmp_path, check=True)

    def run(text: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([tmp_path / "example"], input=text, capture_output=True, text=True, check=False)

    rows = "0,1.0\n0.01,2.0\n0.02,0.0\n"
    plain = run(rows)
    assert plain.returncode == 0 and len(plain.stdout.splitlines()) == 3
    for same in ("t,voltage [V]\n" + rows, "\ufeff" + rows, rows.replace("\n", " \r\n\r\n"), rows.replace(",", " , ")):
        assert (run(same).stdout, run(same).stderr) == (plain.stdout, "")
    for wrong, line in (
        (rows + "0.03,-\n", 4),
        ("t,u\ns,V\n" + rows, 2),
        ("0,1.0,3.0\n", 1),
        ("0\n0.01\n", 1),
        ("0;1.0\n", 1),
    ):
        done = run(wrong)
        assert done.returncode == 1
        assert (
            done.stderr == f"line {line}: expected 2 numbers: a time in seconds and the inputs, separated by commas\n"
        )


@pytest.mark.skipif(not COMPILERS, reason="no C compiler")
def test_every_operation(tmp_path: Path, machines: Path) -> None:
    """Values of all operations that are compiled, at a few points."""
    import ctypes

    import torch

    from greybox_torch.model import Signals

    model = gt.load_model(f"{machines / 'operations.py'}:Operations")
    gt.export(model, to="c", name="ops").save(tmp_path)
    command = [COMPILERS[0], *FLAGS, "-shared", "-fPIC", "ops.c", "-lm", "-o", "ops.so"]
    subprocess.run(command, cwd=tmp_path, check=True)
    library = ctypes.CDLL(str(tmp_path / "ops.so"))
    for a, b, u in ((0.31, -0.72, 0.5), (-1.93, 1.11, -0.4), (0.07, 0.21, 1.7)):
        y = np.zeros(len(model.outputs))
        arrays = [np.array(v) for v in ([a, b], [u], list(model.values().values()))]
        library.ops_outputs(*(v.ctypes.data_as(ctypes.c_void_p) for v in (*arrays, y)))
        number = lambda v: torch.tensor(v, dtype=torch.float64)  # noqa: E731
        with torch.no_grad():
            expected = model.output(
                Signals("state", {"a": number(a), "b": number(b)}), Signals("input", {"u": number(u)}), model.physical()
            )
        np.testing.assert_allclose(y, [float(v) for v in expected.values()], rtol=1e-12, atol=1e-13)


def test_an_effect_can_be_switched_off(tmp_path: Path, arm_with_effects: Machine) -> None:
    made = gt.export(arm_with_effects.model, "c", name="arm")
    switches = [row["name"] for row in made.rows if row["kind"] == "switch"]
    assert switches == ["gear_spring.backlash.share", "actuator.input_lag.share"]
    values = {row["name"]: row["value"] for row in made.rows if row["kind"] == "parameter"}
    assert values["gear_spring.backlash.half_gap"] == 0.03
    assert made.exported.step == 5e-4
    assert made.save(tmp_path) == tuple(tmp_path / name for name in ("arm.h", "arm.c", "example.c"))
    assert "gear_spring.backlash.half_gap" in made._repr_html_()


def test_what_cannot_be_exported() -> None:
    from greybox_torch.mechanisms.actuator import InputDelay
    from greybox_torch.mechanisms.attachment import Attachment
    from greybox_torch.mechanisms.augmented_model import AugmentedModel
    from greybox_torch.mechanisms.mechanism import Range, Surroundings

    class Endless(InputDelay):
        def parameters(self, around: Surroundings) -> list[gt.Parameter]:
            return [gt.Parameter("T", 0.01, "s", lower=0.0)]

    around = {"actuator": Surroundings({"input": Range(-1, 1, 0.5)}, {"input": "N m"}, "N m", 1e-3)}
    arm = gt.load_model("robot_arm")
    delayed = AugmentedModel(arm, [Attachment("actuator", Endless())], around)
    with pytest.raises(gt.UserError, match=r"dead time actuator\.input_delay\.T has no upper bound"):
        gt.export(delayed, to="c")
    with pytest.raises(gt.UserError, match=r"to: found 'fortran', expected one of c, torch"):
        gt.export(arm, to="fortran")
    with pytest.raises(gt.UserError, match="name: found '3d', expected letters"):
        gt.export(arm, to="c", name="3d")
    with pytest.raises(gt.UserError, match="step: found 0"):
        gt.export(arm, to="c", step=0)
