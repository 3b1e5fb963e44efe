"""A graphics processor gives the results that the processor gives, and every call takes one."""

from __future__ import annotations

from typing import Any

import pytest

import greybox_torch as gt
from tests.api.motor import Motor, numbers
from tests.cuda import needs_cuda


@pytest.fixture
def short(data: gt.DataSet) -> gt.DataSet:
    """A second of each recording: an operation on a graphics processor takes its time, however small the model."""
    cut = [
        gt.Recording.from_arrays(
            each.name, {n: s[:100] for n, s in each.signals.items()}, sample_time=0.01, role=each.role
        )
        for each in data.recordings
    ]
    return gt.DataSet(cut, hold=data.hold, name=data.name)


@needs_cuda
def test_simulate_fit_compare_and_residuals(short: gt.DataSet) -> None:
    check_same(gt.simulate(Motor(), short, device="cuda"), gt.simulate(Motor(), short), 1e-7)
    here, there = gt.fit(Motor(), short), gt.fit(Motor(), short, device="cuda")
    for name in ("J", "b"):
        assert there.parameters[name].value == pytest.approx(here.parameters[name].value, rel=1e-5)
        assert there.parameters[name].std == pytest.approx(here.parameters[name].std, rel=1e-3)
    check_same(gt.compare(short, {"fit": there}, device="cuda"), gt.compare(short, {"fit": here}), 1e-2)
    tested = [gt.residuals(here.model, short, device=device).to_dict() for device in ("cuda", "cpu")]
    assert numbers(tested[0]).keys() == numbers(tested[1]).keys()


@needs_cuda
def test_train_and_diagnose_end_with_a_result(short: gt.DataSet) -> None:
    options: dict[str, Any] = {"net": "residual", "port": "actuator", "network": {"units": 2}, "explain": False}
    settings = gt.TrainingSettings(epochs=1)
    check_same(
        gt.train(Motor(), short, settings=settings, device="cuda", **options),
        gt.train(Motor(), short, settings=settings, **options),
        0.1,
    )
    found = gt.diagnose(gt.fit(Motor(), short).model, short, device="cuda", time_limit=20)
    assert found.effects or not found.verdict.complete


def check_same(one: Any, other: Any, points: float) -> None:
    """Two results fit every output of every experiment equally well."""
    rows = [{(r["model"], r["experiment"], r["output"]): r["fit"] for r in found.scores} for found in (one, other)]
    assert rows[0] == pytest.approx(rows[1], abs=points)
