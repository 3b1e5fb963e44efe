"""Independent work on several cores."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from greybox_torch.cores import allowed_cores
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.side_by_side import cores, side_by_side, threads
from greybox_torch.simulation.windows import whole_records
from tests.simulation.arm import X0, P, arm_records, arm_with


@pytest.mark.parametrize("threads", ["1", "3"])
def test_results_come_in_order(monkeypatch: pytest.MonkeyPatch, threads: str) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    assert side_by_side((lambda k=k: k * k) for k in range(9)) == [k * k for k in range(9)]
    assert side_by_side(iter(())) == []


def test_passes_of_torch_operations_leave_one_another_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    records = arm_records((20, 20))
    asked = Pass(whole_records(records), P, np.array([X0, X0]), tangents=True)
    stepper = EagerStepper.of(arm_with(P), ("J", "k_g1"), "cpu", "double")
    alone = stepper.run(records, asked)
    assert alone.dy is not None
    for found in side_by_side([lambda: stepper.run(records, asked)] * 4):
        np.testing.assert_array_equal(found.dy, alone.dy)


def test_work_within_work_has_one_core(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    assert cores() == 2
    assert side_by_side([cores, cores]) == [1, 1]
    names = side_by_side([lambda: side_by_side([threading.current_thread] * 3)] * 2)
    assert all(len({t.name for t in inner}) == 1 for inner in names), "no threads within threads"


def test_the_last_task_has_the_cores_that_the_others_had(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "4")
    both, over = threading.Barrier(2), threading.Event()

    def short() -> list[int]:
        both.wait(10)
        found = [threads(), cores()]
        both.wait(10)
        threading.Timer(0.2, over.set).start()
        return found

    def long() -> list[int]:
        both.wait(10)
        found = [threads(), cores()]
        both.wait(10)
        assert over.wait(10)
        return [*found, threads(), cores()]

    assert threads() == 4
    assert side_by_side([long, short]) == [[2, 1, 4, 1], [2, 1]], "for passes; tasks within tasks have one core"


@pytest.mark.parametrize(
    ("threads", "expected"), [("3", 3), ("4,2", 4), (" 2 ", 2), ("", None), ("all", None), ("0", None), ("-1", None)]
)
def test_any_words_of_openmp_give_a_number_of_cores(
    monkeypatch: pytest.MonkeyPatch, threads: str, expected: int | None
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    assert cores() == (expected or allowed_cores())


def test_an_exception_goes_on_and_what_has_not_begun_is_left_undone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    failed, done = threading.Event(), []

    def fail() -> None:
        failed.set()
        raise KeyError("first")

    def wait() -> None:
        failed.wait(10)

    with pytest.raises(KeyError, match="first"):
        side_by_side([fail, wait, *[lambda: done.append(1)] * 200])
    assert len(done) < 200
