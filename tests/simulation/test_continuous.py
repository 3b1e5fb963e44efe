"""Free runs in parallel over windows against the sequential ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation import parallel_run
from greybox_torch.simulation.continuous import Chain, chain, continuous, sequential_starts
from greybox_torch.simulation.parallel_run import ParallelRun
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems.robot_arm import RobotArm


@pytest.fixture
def sequential(monkeypatch: pytest.MonkeyPatch) -> list[np.ndarray]:
    """Start states of the runs that had to be made sequentially."""
    made: list[np.ndarray] = []

    def counted(simulator: Simulator, records: Records, links: Chain, p: np.ndarray, x0: np.ndarray) -> np.ndarray:
        made.append(x0)
        return sequential_starts(simulator, records, links, p, x0)

    monkeypatch.setattr(parallel_run, "sequential_starts", counted)
    return made


def torque_records(lengths: tuple[int, ...], hold: str, seed: int = 0) -> Records:
    rng = np.random.default_rng(seed)
    total = sum(lengths)
    u = np.repeat(rng.uniform(-6, 6, total // 25 + 1), 25)[:total]
    first = np.concatenate([[0], np.cumsum(lengths)[:-1]])
    y = rng.normal(0, 3, (1, total))
    y[0, ::7] = np.nan
    names = tuple(f"run {e}" for e in range(len(lengths)))
    return Records(u[None], y, np.full(total, 0.002), first, first + np.array(lengths) - 1, names, hold)


@settings(deadline=None)
@given(st.lists(st.integers(2, 5000), min_size=1, max_size=6), st.integers(1, 80))
def test_windows_of_a_chain_cover_every_sample_once(lengths: list[int], count: int) -> None:
    records = torque_records(tuple(lengths), "zoh")
    links = chain(records, count=count)
    seen = np.zeros(sum(lengths), dtype=int)
    for e, row in enumerate(links.order):
        row = row[row >= 0]
        assert (links.experiment[row] == e).all()
        assert links.windows.start[row[0]] == records.first[e]
        for k, w in enumerate(row):
            begin = int(links.windows.start[w])
            end = min(begin + links.windows.steps, int(records.last[e]) + 1)
            assert k == len(row) - 1 or end - begin == links.windows.steps
            seen[begin:end] += 1
    assert (seen == 1).all()
    assert len(links.windows.start) <= max(count, len(lengths))


@pytest.mark.parametrize("hold", ["zoh", "foh"])
@pytest.mark.parametrize("lengths", [(1999,), (1500, 700, 333)])
@pytest.mark.parametrize("substeps", [1, 2])
def test_the_parallel_run_is_the_sequential_one(
    lengths: tuple[int, ...], hold: str, substeps: int, sequential: list[np.ndarray]
) -> None:
    model, records = RobotArm(), torque_records(lengths, hold)
    names = ("F_v", "a_m", "k_g1", "d_a")
    simulator = Simulator.of(model, names, SimulationOptions(substeps=substeps))
    p = np.array(list(model.values().values()))
    estimated = np.array([list(model.values()).index(n) for n in names])
    x0 = np.random.default_rng(1).normal(0, 0.5, (len(lengths), 5))
    states = np.array([0, 2, 4])
    parallel = ParallelRun(simulator, records, estimated, states)
    rough = np.zeros((len(parallel.links.windows.start), 5))
    directions = np.zeros((len(lengths), 3, 5))
    directions[:, np.arange(3), states] = 1.0
    for factor in (1.0, 1.02, 1.15):  # from nothing, from a trajectory nearby, from one farther away
        normals = parallel.normals(records, p * factor, x0 * factor, rough, np.array([0.7]))
        exact = simulator.run(
            records,
            Pass(
                whole_records(records),
                p * factor,
                x0 * factor,
                tangents=True,
                start_directions=directions,
                weights=np.array([0.7]),
            ),
        ).normal
        assert normals is not None and exact is not None
        for parts, whole in zip(normals, exact, strict=True):
            size = np.sqrt(np.outer(np.diag(whole), np.diag(whole)))
            np.testing.assert_allclose(parts.sum(axis=0) / size, whole / size, atol=1e-9)
        found = parallel.errors(records, p * factor, x0 * factor, rough, np.array([0.7]))
        assert found is not None
        for (errors, slopes), whole in zip(found, exact, strict=True):
            both = np.concatenate([slopes, errors[..., None]], axis=2).reshape(len(errors), -1)
            size = np.sqrt(np.outer(np.diag(whole), np.diag(whole)))
            np.testing.assert_allclose(both.T @ both / size, whole / size, atol=1e-9)
    assert len(sequential) <= 1  # at most the one from nothing


class Escaping(GreyBoxModel):
    """dx/dt = x³ a + u: leaves for infinity from where x is large."""

    states = [State("x", "", initial=0.0)]
    inputs = [Input("u", "")]
    outputs = [Output("y", "")]
    parameters = [Parameter("a", 1.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"x": p.a * x.x**3 + u.u}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"y": x.x}


def test_a_run_that_overflows_is_none(sequential: list[np.ndarray]) -> None:
    records = torque_records((800,), "zoh")
    parallel = ParallelRun(Simulator.of(Escaping(), ("a",)), records, np.array([0]), np.array([0]))
    rough = np.zeros((len(parallel.links.windows.start), 1))
    assert parallel.normals(records, np.array([5.0]), np.array([[3.0]]), rough, np.ones(1)) is None
    assert len(sequential) == 1
    assert parallel.errors(records, np.array([5.0]), np.array([[3.0]]), rough, np.ones(1)) is None


def test_where_newton_fails_the_sequential_run_serves(sequential: list[np.ndarray]) -> None:
    """Chaos: neighbouring trajectories part so quickly that no window start can be corrected from afar."""
    records = torque_records((1500,), "zoh")
    model = Lorenz()
    simulator = Simulator.of(model, ("rho",))
    links = chain(records)
    p, x0 = np.array([28.0]), np.array([[1.0, 1.0, 20.0]])
    rough = np.tile([[-8.0, 8.0, 27.0]], (len(links.windows.start), 1))
    wide = Records(records.u, records.y, np.full(1500, 0.02), records.first, records.last, records.names, "zoh")
    assert continuous(simulator, wide, links, p, x0, guess=rough) is None
    starts = sequential_starts(simulator, wide, links, p, x0)
    run = simulator.run(wide, Pass(whole_records(wide), p, x0, keep_states=True))
    assert run.states is not None
    np.testing.assert_allclose(starts, run.states[0, links.windows.start], rtol=1e-12)
    parallel = ParallelRun(simulator, wide, np.array([0]), np.array([0]))
    assert parallel.normals(wide, p, x0, rough, np.ones(1)) is not None
    assert len(sequential) == 1


class Lorenz(GreyBoxModel):
    """E. N. Lorenz, "Deterministic nonperiodic flow", 1963."""

    states = [State("x", "", initial=1.0), State("y", "", initial=1.0), State("z", "", initial=20.0)]
    inputs = [Input("u", "")]
    outputs = [Output("out", "")]
    parameters = [Parameter("rho", 28.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {
            "x": 10.0 * (x.y - x.x),
            "y": x.x * (p.rho - x.z) - x.y + 0.0 * u.u,
            "z": x.x * x.y - 8.0 / 3.0 * x.z,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"out": x.x}


class Counting(RobotArm):
    """The arm with a state that grows and acts on nothing."""

    states = [*RobotArm.states, State("count", "")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {**super().derivative(x, u, p, port), "count": x.motor_speed * x.motor_speed + x.count}


def test_a_state_that_acts_on_nothing_is_no_hindrance(sequential: list[np.ndarray]) -> None:
    records = torque_records((1200, 900), "zoh")
    names, results = ("F_v", "a_m", "k_g1"), []
    for model in (RobotArm(), Counting()):
        values = model.values()
        parallel = ParallelRun(
            Simulator.of(model, names), records, np.array([list(values).index(n) for n in names]), np.array([2, 4])
        )
        rough = np.zeros((len(parallel.links.windows.start), len(model.states)))
        x0 = np.zeros((2, len(model.states)))
        results.append(parallel.normals(records, np.array(list(values.values())), x0, rough, np.ones(1)))
        assert not sequential
    assert results[0] is not None and results[1] is not None
    for plain, counting in zip(*results, strict=True):
        np.testing.assert_allclose(counting, plain, rtol=1e-9, atol=1e-9 * np.abs(plain).max())
