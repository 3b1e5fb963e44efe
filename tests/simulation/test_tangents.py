"""Sensitivities of the stepper against differences, and normal matrices summed as the windows go."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass, Probes
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import Windows, whole_records
from tests.simulation.arm import ARM, PARAMETERS, X0, P, arm_records, native


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
