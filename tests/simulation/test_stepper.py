"""The stepper against everything that computes the same: itself uncompiled, torchdiffeq, scipy, analytic solutions, differences."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.passes import Pass, Probes
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import SimulationOptions, make_stepper
from greybox_torch.simulation.windows import Windows, cut, whole_records
from greybox_torch.systems import RobotArm

ARM = RobotArm()
PARAMETERS = tuple(p.name for p in ARM.declared_parameters)
P = np.array([{**ARM.values(), "k_g3": 24.0}[name] for name in PARAMETERS])
X0 = np.array([0.02, -0.01, 15.0, 14.0, 16.0])


def arm_records(lengths: tuple[int, ...] = (120,), hold: str = "zoh", step: float = 5e-4) -> Records:
    """A torque like that of a slow turn with a rich excitation on top, in N m."""
    total = sum(lengths)
    t = step * np.arange(total)
    torque = 2.0 * np.sin(8.0 * t) + sum(np.sin(2 * np.pi * f * t + f) for f in (7.0, 19.0, 31.0, 53.0))
    first = np.concatenate([[0], np.cumsum(lengths)[:-1]])
    last = np.cumsum(lengths) - 1
    return Records(torque[None], np.zeros((1, total)), np.full(total, step), first, last, ("",) * len(lengths), hold)


def native(model: GreyBoxModel = ARM, names: tuple[str, ...] = PARAMETERS, **options: Any) -> NativeStepper:
    stepper = make_stepper(model, names, **options)
    assert isinstance(stepper, NativeStepper)
    return stepper


def scipy_states(records: Records, rates: Callable[[np.ndarray, np.ndarray], np.ndarray], x0: np.ndarray) -> np.ndarray:
    """States at the samples of records's first experiment, integrated from sample to sample at tight tolerance."""
    states = [x0]
    for n in range(int(records.last[0])):
        h, u0, u1 = records.dt[n], records.u[:, n], records.u[:, n + (records.hold == "foh")]
        between = lambda t, x, h=h, u0=u0, u1=u1: rates(x, u0 + t / h * (u1 - u0))  # noqa: E731
        states.append(solve_ivp(between, (0.0, h), states[-1], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1])
    return np.array(states)


def arm_rates(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The arm's equations once more, in numpy."""
    v = dict(zip(PARAMETERS, P, strict=True))
    twist, arm_twist, motor, gearbox, arm = x
    friction = v["F_v"] * motor + (v["F_c"] + v["F_cs"] / np.cosh(v["alpha"] * motor)) * np.tanh(v["beta"] * motor)
    gear = v["k_g1"] * twist + v["k_g3"] * twist**3 + v["d_g"] * (motor - gearbox)
    spring = v["k_a"] * arm_twist + v["d_a"] * (gearbox - arm)
    return np.array(
        [
            motor - gearbox,
            gearbox - arm,
            (u[0] - friction - gear) / (v["J"] * v["a_m"]),
            (gear - spring) / (v["J"] * v["a_g"]),
            spring / (v["J"] * (1 - v["a_m"] - v["a_g"])),
        ]
    )


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_compiled_and_eager_agree(hold: str) -> None:
    records = arm_records((60, 40, 25), hold)
    windows = Windows(np.array([0, 60, 100, 30]), np.array([59, 99, 124, 59]), 40)
    rng = np.random.default_rng(0)
    p = P * (1 + 0.05 * rng.standard_normal((4, len(P))))
    x0 = X0 + rng.standard_normal((4, 5)) * [0.01, 0.01, 1, 1, 1]
    options = {
        "tangents": True,
        "start_directions": np.broadcast_to(np.eye(5), (4, 5, 5)),
        "tangents0": rng.standard_normal((4, len(P), 5)),
        "keep_states": True,
    }
    one = native().run(records, Pass(windows, p, x0, **options), substeps=2)
    other = EagerStepper.of(ARM, PARAMETERS, "cpu", "double").run(records, Pass(windows, p, x0, **options), substeps=2)
    for part in ("y", "dy", "x_end", "dx_end", "states"):
        expected = getattr(other, part)
        np.testing.assert_allclose(
            getattr(one, part), expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max(), err_msg=part
        )


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_against_scipy(hold: str) -> None:
    records = arm_records((80,), hold)
    expected = scipy_states(records, arm_rates, X0)
    run = native(names=()).run(records, Pass(whole_records(records), P, X0[None], keep_states=True), substeps=8)
    assert run.states is not None
    np.testing.assert_allclose(run.states[0], expected, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(run.y[0, :, 0], expected[:, 2], rtol=1e-8)


@pytest.mark.parametrize("hold", ["zoh", "foh"])
@pytest.mark.parametrize(("method", "tolerance"), [("rk4", 2e-6), ("dopri5", 2e-8)])
def test_against_torchdiffeq(hold: str, method: str, tolerance: float) -> None:
    records = arm_records((60, 45), hold)
    windows = Windows(np.array([0, 20, 60]), np.array([59, 59, 104]), 40)
    model = arm_with(P)
    x0 = X0 + np.array([[0, 0, 0, 0, 0], [0.01, 0, 1, 0, 0], [0, 0.02, -3, 2, 1]])
    outputs = solve(model, records, windows, torch.tensor(x0.T), method=method, rtol=1e-11, atol=1e-12)
    run = native(names=()).run(records, Pass(windows, P, x0), substeps=1 if method == "rk4" else 8)
    np.testing.assert_allclose(run.y[..., 0].T, outputs[0].detach().numpy(), rtol=tolerance, atol=tolerance)


def arm_with(values: np.ndarray) -> RobotArm:
    arm = RobotArm()
    arm.set_values(dict(zip(PARAMETERS, values, strict=True)))
    return arm


def test_uneven_sample_times() -> None:
    records = arm_records((40,), "foh")
    uneven = Records(
        records.u,
        records.y,
        records.dt * np.random.default_rng(1).uniform(0.3, 1.5, 40),
        *arm_ends(records),
        records.hold,
    )
    run = native(names=()).run(uneven, Pass(whole_records(uneven), P, X0[None], keep_states=True), substeps=8)
    assert run.states is not None
    np.testing.assert_allclose(run.states[0], scipy_states(uneven, arm_rates, X0), rtol=1e-8, atol=1e-8)


def arm_ends(records: Records) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    return records.first, records.last, records.names


class Oscillator(GreyBoxModel):
    """x'' + 2 d w x' + w² x = u, whose solution under a first-order hold is known in closed form."""

    states = [State("x"), State("v")]
    inputs = [Input("u")]
    outputs = [Output("x")]
    parameters = [Parameter("w", 2.0), Parameter("d", 0.1)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"x": x.v, "v": u.u - 2 * p.d * p.w * x.v - p.w**2 * x.x}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"x": x.x}


def oscillator_solution(records: Records, x0: np.ndarray) -> np.ndarray:
    """With the input's value and slope as further states, a sample is one matrix exponential."""
    w, d, h = 2.0, 0.1, records.dt[0]
    a = np.array([[0, 1, 0, 0], [-(w**2), -2 * d * w, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    step, x, positions = expm(a * h), x0, []
    for n in range(len(records.dt)):
        positions.append(x[0])
        following = records.u[0, min(n + 1, len(records.dt) - 1)] if records.hold == "foh" else records.u[0, n]
        x = (step @ np.array([*x, records.u[0, n], (following - records.u[0, n]) / h]))[:2]
    return np.array(positions)


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_order_of_convergence(hold: str) -> None:
    records = Records(
        np.sin(np.arange(30.0))[None], np.zeros((1, 30)), np.full(30, 0.4), np.array([0]), np.array([29]), ("",), hold
    )
    x0, p = np.array([1.0, -0.5]), np.array([2.0, 0.1])
    exact = oscillator_solution(records, x0)
    stepper = native(Oscillator(), ())
    errors = [
        np.abs(stepper.run(records, Pass(whole_records(records), p, x0[None]), substeps=m).y[0, :, 0] - exact).max()
        for m in (1, 2, 4, 8, 16)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders[1:], 4.0, atol=0.15)
    assert errors[-1] < 1e-6


def test_tangents_of_every_parameter_and_start_state() -> None:
    records, start = (
        arm_records((200,)),
        np.array([0.02, -0.01, 0.5, -1.0, 2.0]),
    )  # slow, so that all of the friction shows
    windows, stepper = whole_records(records), native()
    run = stepper.run(
        records, Pass(windows, P, start[None], tangents=True, start_directions=np.eye(5)[None], keep_states=True)
    )
    assert run.dy is not None
    assert run.dx_end is not None

    def outputs(p: np.ndarray, x0: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        plain = stepper.run(records, Pass(windows, p, x0[None]))
        return plain.y[0, :, 0], plain.x_end[0]

    point = np.concatenate([P, start])
    for k in range(len(point)):
        step = 1e-5 * max(abs(point[k]), 1e-2)
        above, below = point.copy(), point.copy()
        above[k] += step
        below[k] -= step
        (y1, x1), (y0, x0) = (outputs(z[: len(P)], z[len(P) :]) for z in (above, below))
        difference, ends = (y1 - y0) / (2 * step), (x1 - x0) / (2 * step)
        name = [*PARAMETERS, *(s.name for s in ARM.states)][k]
        assert np.abs(difference).max() > 0, name
        np.testing.assert_allclose(
            run.dy[0, :, 0, k], difference, rtol=2e-6, atol=2e-6 * np.abs(difference).max(), err_msg=name
        )
        np.testing.assert_allclose(run.dx_end[0, k], ends, rtol=2e-6, atol=2e-6 * np.abs(ends).max(), err_msg=name)


@pytest.mark.parametrize(("method", "adjoint"), [("rk4", False), ("rk4", True), ("dopri5", True)])
def test_gradients_of_the_torchdiffeq_route(method: str, adjoint: bool) -> None:
    """Against differences of the stepper's loss, which has no step control to make it rough."""
    records = arm_records((40,))
    windows, stepper = whole_records(records), native(names=())
    target = np.linspace(14.0, 17.0, 40)

    def loss(p: np.ndarray, x0: np.ndarray) -> float:
        return float(((stepper.run(records, Pass(windows, p, x0[None]), substeps=8).y[0, :, 0] - target) ** 2).sum())

    model, leaf = arm_with(P), torch.tensor(X0[:, None], requires_grad=True)
    outputs = solve(model, records, windows, leaf, method=method, adjoint=adjoint, rtol=1e-9, atol=1e-10)
    ((outputs[0, :, 0] - torch.tensor(target)) ** 2).sum().backward()
    assert leaf.grad is not None
    for name in ("J", "k_g1", "F_c", "d_a"):
        value = model.values()[name]
        above, below = (loss(changed(name, value * (1 + s)), X0) for s in (1e-5, -1e-5))
        gradient = model.raw[name].grad / model._scales[name]
        assert float(gradient) == pytest.approx((above - below) / (2e-5 * value), rel=1e-5), name
    for i, direction in enumerate(np.eye(5)):
        step = 1e-5 * max(abs(X0[i]), 0.01)
        above, below = (loss(P, X0 + s * step * direction) for s in (1, -1))
        assert float(leaf.grad[i, 0]) == pytest.approx((above - below) / (2 * step), rel=1e-5), i


def changed(name: str, value: float) -> np.ndarray:
    return np.array([{**dict(zip(PARAMETERS, P, strict=True)), name: value}[n] for n in PARAMETERS])


@pytest.mark.parametrize("compiled", [True, False])
def test_single_precision(compiled: bool) -> None:
    records = arm_records((60,))
    double = native().run(records, Pass(whole_records(records), P, X0[None], tangents=True))
    single = (
        native(options=SimulationOptions(precision="float"))
        if compiled
        else EagerStepper.of(ARM, PARAMETERS, "cpu", "float")
    )
    run = single.run(records, Pass(whole_records(records), P, X0[None], tangents=True))
    assert double.dy is not None
    assert run.dy is not None
    assert 0 < np.abs(run.y - double.y).max() < 1e-3
    np.testing.assert_allclose(run.dy, double.dy, rtol=1e-2, atol=1e-3 * np.abs(double.dy).max())


def test_windows_are_pieces_of_one_run() -> None:
    records = arm_records((150,))
    whole = native().run(records, Pass(whole_records(records), P, X0[None], tangents=True, keep_states=True))
    assert whole.states is not None
    starts = np.array([0, 1, 17, 64, 100])
    windows = Windows(starts, np.full(5, 149), 50)
    pieces = native().run(records, Pass(windows, P, whole.states[0, starts], keep_states=True))
    assert pieces.states is not None
    for piece, start in zip(range(5), starts, strict=True):
        np.testing.assert_allclose(pieces.y[piece], whole.y[0, start : start + 50], rtol=1e-12)
        np.testing.assert_allclose(pieces.states[piece], whole.states[0, start : start + 50], rtol=1e-12, atol=1e-15)


def test_a_record_continued_in_chunks() -> None:
    """The end of a chunk, with its tangents, is where the next begins."""
    records = arm_records((120,))
    whole = native().run(records, Pass(whole_records(records), P, X0[None], tangents=True))
    first = native().run(records, Pass(Windows(np.array([0]), np.array([119]), 70), P, X0[None], tangents=True))
    rest = native().run(
        records,
        Pass(Windows(np.array([70]), np.array([119]), 50), P, first.x_end, tangents=True, tangents0=first.dx_end),
    )
    for part in ("y", "dy"):
        joined = np.concatenate([getattr(first, part), getattr(rest, part)], axis=1)
        np.testing.assert_allclose(joined, getattr(whole, part), rtol=1e-12, atol=1e-12)


def test_experiments_of_unequal_length() -> None:
    """Side by side they give what each gives alone, whatever stands next to it on the records."""
    lengths = (90, 11, 47)
    records = arm_records(lengths)
    x0 = X0 * np.array([[1.0], [0.5], [-1.0]])
    together = native().run(records, Pass(whole_records(records), P, x0, tangents=True))
    for e, n in enumerate(lengths):
        part = records.span(e)
        alone = Records(
            records.u[:, part], records.y[:, part], records.dt[part], np.array([0]), np.array([n - 1]), ("",), "zoh"
        )
        run = native().run(alone, Pass(whole_records(alone), P, x0[e : e + 1], tangents=True))
        assert run.dy is not None
        assert together.dy is not None
        np.testing.assert_array_equal(together.y[e, :n], run.y[0])
        np.testing.assert_array_equal(together.dy[e, :n], run.dy[0])


def test_more_windows_than_lanes() -> None:
    """Windows beyond a vector's width, each with parameters of its own, do not mix."""
    records = arm_records((60,))
    count = 19
    p = P * np.linspace(0.9, 1.1, count)[:, None]
    together = native().run(
        records, Pass(Windows(np.zeros(count, int), np.full(count, 59), 60), p, np.tile(X0, (count, 1)))
    )
    for w in (0, 7, 8, 18):
        alone = native().run(records, Pass(whole_records(records), p[w], X0[None]))
        np.testing.assert_array_equal(together.y[w], alone.y[0])


def test_a_model_without_inputs_and_parameters() -> None:
    class Decay(GreyBoxModel):
        states = [State("x")]
        outputs = [Output("x")]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"x": -x.x}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"x": x.x}

    records = Records(
        np.zeros((0, 20)), np.zeros((1, 20)), np.full(20, 0.1), np.array([0]), np.array([19]), ("",), "zoh"
    )
    for stepper in (native(Decay(), ()), EagerStepper.of(Decay(), (), "cpu", "double")):
        y = stepper.run(records, Pass(whole_records(records), np.zeros(0), np.ones((1, 1))), substeps=4).y
        np.testing.assert_allclose(y[0, :, 0], np.exp(-0.1 * np.arange(20)), rtol=1e-7)


@pytest.mark.parametrize(
    ("lengths", "length"), [((100,), 30), ((100, 64), 32), ((10,), 30), ((95, 7), 10), ((101,), 1), ((45,), 30)]
)
def test_cut(lengths: tuple[int, ...], length: int) -> None:
    """Every sample is in one window, no window crosses experiments, and all are about as long as they should be."""
    records = arm_records(lengths)
    windows = cut(records, length)
    sizes = windows.last - windows.start + 1
    experiment = np.searchsorted(records.first, windows.start, side="right") - 1
    assert (windows.last <= records.last[experiment]).all()
    samples = [np.arange(a, b + 1) for a, b in zip(windows.start, windows.last, strict=True)]
    assert np.concatenate(samples).tolist() == list(range(sum(lengths)))
    assert windows.steps == sizes.max() <= 1.5 * length
    assert (sizes >= np.minimum(length / 2, np.array(lengths)[experiment])).all()


@pytest.mark.parametrize("compiled", [True, False])
def test_normal_matrices(compiled: bool) -> None:
    """[J e]ᵀ[J e] summed as the windows go, against the sensitivities kept and multiplied afterwards."""
    records = arm_records((50, 33))
    y = np.random.default_rng(2).normal(15.0, 2.0, records.y.shape)
    y[0, [3, 4, 60]] = np.nan
    records = Records(records.u, y, records.dt, records.first, records.last, records.names, records.hold)
    windows = Windows(np.array([0, 20, 50]), np.array([19, 49, 82]), 33)
    names, x0 = ("J", "k_g1", "F_c"), np.tile(X0, (3, 1))
    stepper = native(names=names) if compiled else EagerStepper.of(ARM, names, "cpu", "double")
    directions = np.broadcast_to(np.eye(5)[[2, 4]], (3, 2, 5))
    options: dict[str, Any] = {"tangents": True, "start_directions": directions}
    kept = stepper.run(records, Pass(windows, P, x0, **options), substeps=2)
    summed = stepper.run(records, Pass(windows, P, x0, weights=np.array([0.3]), **options), substeps=2)
    assert kept.dy is not None
    assert summed.normal is not None
    assert summed.dy is None
    for w, (first, last) in enumerate(zip(windows.start, windows.last, strict=True)):
        size = last - first + 1
        errors = 0.3 * (y[0, first : last + 1] - kept.y[w, :size, 0])
        columns = np.column_stack([0.3 * kept.dy[w, :size, 0], errors])[~np.isnan(errors)]
        expected = columns.T @ columns
        np.testing.assert_allclose(summed.normal[w], expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("compiled", [True, False])
def test_normal_matrices_of_probes_lack_only_what_is_not_wanted(compiled: bool) -> None:
    records = arm_records((50, 33))
    windows = Windows(np.arange(0, 80, 8), np.arange(7, 87, 8).clip(max=82), 8)
    names, x0 = PARAMETERS, np.tile(X0, (10, 1))
    stepper = native(names=names) if compiled else EagerStepper.of(ARM, names, "cpu", "double")
    directions = np.broadcast_to(np.eye(5), (10, 5, 5))
    options: dict[str, Any] = {"tangents": True, "start_directions": directions, "weights": np.ones(1)}
    full = stepper.run(records, Pass(windows, P, x0, **options)).normal
    probes = Probes(len(names) - 2, 1)
    run = stepper.run(records, Pass(windows, P, x0, probes=probes, **options))
    packed = run.packed
    assert full is not None and packed is not None and run.normal is None
    size = full.shape[1]
    near = np.ones((size, size), dtype=bool)
    near[2 : len(names), 2 : len(names)] = (
        np.abs(np.subtract.outer(np.arange(2, len(names)), np.arange(2, len(names)))) <= 1
    )
    close = {"rtol": 1e-12, "atol": 1e-12 * np.abs(full).max()}
    np.testing.assert_allclose(np.where(near, packed.total(), 0.0), np.where(near, full.sum(axis=0), 0.0), **close)
    index = np.arange(len(names), size)
    np.testing.assert_allclose(packed.rows(index), full[:, index], **close)
    np.testing.assert_allclose(packed.diagonal(), np.einsum("wii->wi", full), **close)
    pairs = np.array([[2, 3], [5, 6]])
    np.testing.assert_allclose(packed.blocks(pairs), full[:, pairs[:, :, None], pairs[:, None, :]], **close)


def test_parameters_that_are_zero_throughout() -> None:
    """What a screen asks: the sensitivity to a parameter at zero, from code in which it is zero."""
    records = arm_records((60,))
    p = np.array([{**dict(zip(PARAMETERS, P, strict=True)), "k_g3": 0.0, "d_a": 0.0}[n] for n in PARAMETERS])
    names = ("k_g1", "k_g3", "d_a")
    plain = native(names=names).run(records, Pass(whole_records(records), p, X0[None], tangents=True))
    at_zero = native(names=names, at_zero=("k_g3", "d_a")).run(
        records, Pass(whole_records(records), P, X0[None], tangents=True)
    )
    assert plain.dy is not None
    assert at_zero.dy is not None
    np.testing.assert_allclose(at_zero.y, plain.y, rtol=1e-13)
    np.testing.assert_allclose(at_zero.dy, plain.dy, rtol=1e-11, atol=1e-12 * np.abs(plain.dy).max())


def test_states_that_act_on_nothing() -> None:
    """A position that no output sees is simulated like any other state."""

    class Travelled(Oscillator):
        states = [*Oscillator.states, State("way")]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {**super().derivative(x, u, p, port), "way": x.v}

    records = Records(
        np.sin(np.arange(30.0))[None], np.zeros((1, 30)), np.full(30, 0.1), np.array([0]), np.array([29]), ("",), "zoh"
    )
    p, x0 = np.array([2.0, 0.1]), np.array([[1.0, -0.5, 7.0]])
    run = native(Travelled(), ("w",)).run(records, Pass(whole_records(records), p, x0, tangents=True, keep_states=True))
    other = EagerStepper.of(Travelled(), ("w",), "cpu", "double").run(
        records, Pass(whole_records(records), p, x0, tangents=True, keep_states=True)
    )
    assert run.states is not None
    assert other.states is not None
    np.testing.assert_allclose(run.states, other.states, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(run.states[0, :, 2] - 7.0, run.states[0, :, 0] - 1.0, atol=1e-12)
    assert run.dy is not None
    assert other.dy is not None
    np.testing.assert_allclose(run.dy, other.dy, rtol=1e-12, atol=1e-12)
