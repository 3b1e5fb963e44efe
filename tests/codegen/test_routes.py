"""Which models are compiled, which are not, and that both routes give the same numbers."""

from __future__ import annotations

import importlib.util
import platform
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from greybox_torch.codegen import build
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.windows import Windows, whole_records
from greybox_torch.systems import RobotArm


def lag(rate: Any) -> GreyBoxModel:
    """A model with one state and the rate ``rate(x, u, p)``."""

    class Lag(GreyBoxModel):
        states = [State("level")]
        inputs = [Input("flow")]
        outputs = [Output("level")]
        parameters = [Parameter("k", 0.7, lower=0.0)]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"level": rate(x, u, p)}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"level": x.level}

    return Lag()


def plain(x: Any, u: Any, p: Any) -> Any:
    return u.flow - p.k * torch.sqrt(x.level**2 + 0.1)


def with_hypot(x: Any, u: Any, p: Any) -> Any:
    return u.flow - p.k * torch.hypot(x.level, torch.full_like(x.level, 0.1**0.5))


@pytest.fixture
def records() -> Records:
    u = np.sin(0.3 * np.arange(50))[None]
    return Records(u, np.zeros((1, 50)), np.full(50, 0.1), np.array([0]), np.array([49]), ("one",), "zoh")


def simulated(stepper: Stepper, records: Records) -> tuple[np.ndarray, np.ndarray]:
    run = stepper.run(records, Pass(whole_records(records), np.array([0.7]), np.ones((1, 1)), tangents=True))
    assert run.dy is not None
    return run.y, run.dy


def test_operation_that_is_not_traced_falls_back(records: Records) -> None:
    compiled, fallen = make_stepper(lag(plain), ("k",)), make_stepper(lag(with_hypot), ("k",))
    assert isinstance(compiled, NativeStepper)
    assert isinstance(fallen, EagerStepper)
    for one, other in zip(simulated(compiled, records), simulated(fallen, records), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)


def test_form_of_an_operation_that_is_not_traced_falls_back() -> None:
    def rate(x: Any, u: Any, p: Any) -> Any:
        return u.flow - torch.stack([x.level, x.level]).sum(dim=0, dtype=torch.float32).to(torch.int32) * p.k

    assert isinstance(make_stepper(lag(rate), ()), EagerStepper)


def test_without_a_compiler(records: Records, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = make_stepper(lag(plain), ("k",))
    monkeypatch.setenv("GREYBOX_COMPILER", "off")
    build.library.cache_clear()
    eager = make_stepper(lag(plain), ("k",))
    build.library.cache_clear()
    assert isinstance(eager, EagerStepper)
    for one, other in zip(simulated(compiled, records), simulated(eager, records), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    "rate",
    [
        lambda x, u, p: u.flow if x.level > 0 else -p.k,
        lambda x, u, p: u.flow if p.k > 0 else x.level,
        lambda x, u, p: max(x.level, u.flow),
        lambda x, u, p: x.level * float(u.flow),
        lambda x, u, p: x.level.item() * p.k,
    ],
    ids=["if a state", "if a parameter", "max", "float", "item"],
)
def test_equations_that_branch_are_refused(rate: Any) -> None:
    with pytest.raises(UserError, match=r"torch\.where"):
        make_stepper(lag(rate), ())


def test_equations_that_raise_are_refused() -> None:
    def rate(x: Any, u: Any, p: Any) -> Any:
        return u.flow + undefined_name  # type: ignore[name-defined]  # noqa: F821

    with pytest.raises(UserError, match=r"test_routes\.py, line \d+: .*NameError.*undefined_name"):
        make_stepper(lag(rate), ())
    with pytest.raises(UserError, match=r"expected functions of torch .*, such as torch\.sin"):
        make_stepper(lag(lambda x, u, p: np.sin(x.level)), ())
    with pytest.raises(UserError, match=r"'stage', which is not declared \(declared: level\)"):
        make_stepper(lag(lambda x, u, p: x.stage), ())


def test_every_parameter_and_state_constant_is_allowed(records: Records) -> None:
    model = lag(lambda x, u, p: torch.zeros((), dtype=torch.float64))
    y, dy = simulated(make_stepper(model, ("k",)), records)
    assert (y == 1.0).all()
    assert (dy == 0.0).all()


def test_compiled_code_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, records: Records) -> None:
    monkeypatch.setenv("GREYBOX_CACHE", str(tmp_path))
    build.library.cache_clear()
    compiled = make_stepper(lag(plain), ("k",))
    assert isinstance(compiled, NativeStepper)
    (file,) = tmp_path.glob("*.so")
    before = file.stat().st_ino

    def no_compiler(*_: Any) -> bool:
        raise AssertionError("compiled again")

    monkeypatch.setattr(build, "_compile", no_compiler)
    build.library.cache_clear()  # as in a new process
    again = make_stepper(lag(plain), ("k",))
    build.library.cache_clear()
    assert isinstance(again, NativeStepper)
    assert file.stat().st_ino == before
    np.testing.assert_array_equal(simulated(compiled, records)[0], simulated(again, records)[0])


def test_damaged_cache_is_compiled_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, records: Records) -> None:
    monkeypatch.setenv("GREYBOX_CACHE", str(tmp_path))
    expected = simulated(make_stepper(lag(plain), ("k",)), records)[0]
    build.library.cache_clear()
    make_stepper(lag(plain), ("k",))
    (file,) = tmp_path.glob("*.so")
    file.unlink()  # the loaded library stays mapped; a new file takes its name
    file.write_bytes(b"not a library")
    build.library.cache_clear()
    again = make_stepper(lag(plain), ("k",))
    build.library.cache_clear()
    assert isinstance(again, NativeStepper)
    np.testing.assert_array_equal(simulated(again, records)[0], expected)


def test_stribeck_term_does_not_overflow_at_high_speed() -> None:
    arm = RobotArm()
    records = Records(
        np.zeros((1, 5)), np.zeros((1, 5)), np.full(5, 5e-4), np.array([0]), np.array([4]), ("one",), "zoh"
    )
    p = np.array([{**arm.values(), "alpha": 50.0}[d.name] for d in arm.declared_parameters])
    run = make_stepper(arm, ("alpha", "F_cs")).run(
        records, Pass(whole_records(records), p, np.array([[0.0, 0.0, 50.0, 50.0, 50.0]]), tangents=True)
    )
    assert run.dy is not None
    assert np.isfinite(run.y).all()
    assert np.isfinite(run.dy).all()


@pytest.fixture
def no_compiler(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A machine without any: nothing on the PATH, no package."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.delenv("GREYBOX_COMPILER", raising=False)
    monkeypatch.setattr(build.importlib.util, "find_spec", lambda name: None)


@pytest.mark.usefixtures("no_compiler")
def test_what_needs_a_compiler_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert build.compiler() is None
    with pytest.raises(
        UserError, match=r"a diagnosis needs a C\+\+ compiler: .*pip install 'greybox_torch\[compiler\]'"
    ):
        build.check_compiler("a diagnosis")
    monkeypatch.setattr(build.importlib.util, "find_spec", lambda name: name)
    assert build.compiler() == (sys.executable, "-m", "ziglang", "c++")
    monkeypatch.setattr(build, "library", lambda source: object())  # as if it worked; tests/codegen/test_build.py
    build.check_compiler("a diagnosis")
    for name in ("clang++", "g++", "own"):  # each goes before those that were found so far
        program = tmp_path / name
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)
        if name == "own":
            monkeypatch.setenv("CXX", name)
        assert build.compiler() == (str(program),)
    monkeypatch.setenv("GREYBOX_COMPILER", "off")
    with pytest.raises(UserError, match="GREYBOX_COMPILER is off"):
        build.check_compiler("a diagnosis")


@pytest.mark.skipif(platform.machine() != "x86_64", reason="no processor with AVX")
@pytest.mark.parametrize("windows", [1, 4, 5, 8, 11])
def test_narrow_vectors_give_the_same_numbers(
    windows: int, records: Records, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Four windows in a vector, as on processors without AVX-512; groups that are full and groups that are not."""
    usual = make_stepper(lag(plain), ("k",))
    monkeypatch.setenv("GREYBOX_CACHE", str(tmp_path))
    monkeypatch.setattr(build, "FLAGS", (*build.FLAGS, "-mno-avx512f"))
    build.library.cache_clear()
    narrow = make_stepper(lag(plain), ("k",))
    build.library.cache_clear()
    assert isinstance(narrow, NativeStepper) and narrow.lanes == 4
    starts = np.linspace(0.5, 2.0, windows)[:, None]
    cut = Windows(np.arange(windows), np.full(windows, 49), 30)
    asked = Pass(cut, np.array([0.7]), starts, tangents=True, weights=np.ones(1))
    runs = [stepper.run(records, asked) for stepper in (usual, narrow)]
    for name in ("y", "x_end", "dx_end", "normal"):
        one, other = (getattr(run, name) for run in runs)
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the package ziglang is not installed")
def test_the_compiler_of_a_package(records: Records, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    compiled = make_stepper(lag(plain), ("k",))
    monkeypatch.setenv("GREYBOX_CACHE", str(tmp_path))
    monkeypatch.setattr(build, "compiler", lambda: build.ZIG)
    build.library.cache_clear()
    other = make_stepper(lag(plain), ("k",))
    build.library.cache_clear()
    assert isinstance(other, NativeStepper)
    for one, two in zip(simulated(compiled, records), simulated(other, records), strict=True):
        np.testing.assert_allclose(one, two, rtol=1e-12, atol=1e-12)
