"""Work within a deadline ends at its next pass, in whatever thread it is done."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pytest

from greybox_torch.deadline import Deadline, TimeIsUp, check_time, until
from greybox_torch.simulation.side_by_side import side_by_side


def test_what_is_within_ends_and_what_is_around_goes_on() -> None:
    check_time()
    with until(Deadline.after(None)), until(Deadline.after(1000.0)):
        check_time()
        with pytest.raises(TimeIsUp), until(Deadline.after(-1.0)):
            check_time()
        check_time()
    with pytest.raises(TimeIsUp), until(Deadline.after(-1.0)), until(Deadline()):
        check_time()
    check_time()


def test_seconds_that_are_left() -> None:
    assert Deadline().left == float("inf") and not Deadline().passed
    assert 999.0 < Deadline.after(1000.0).left <= 1000.0
    assert Deadline.after(-1.0).left < -1.0 and Deadline.after(-1.0).passed


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "2")


@pytest.mark.usefixtures("two_cores")
def test_a_deadline_holds_in_the_threads_of_what_is_done_side_by_side() -> None:
    threads = set()

    def work() -> None:
        threads.add(threading.current_thread())
        check_time()

    side_by_side([work] * 4)
    with pytest.raises(TimeIsUp), until(Deadline.after(-1.0)):
        side_by_side([work] * 4)
    assert threading.current_thread() not in threads


@pytest.mark.usefixtures("two_cores")
@pytest.mark.parametrize("stop", [KeyboardInterrupt, ZeroDivisionError])
def test_where_one_fails_the_others_end_at_their_next_pass(stop: type[BaseException]) -> None:
    began, ended = threading.Event(), []

    def endless() -> None:
        began.set()
        give_up = time.perf_counter() + 30.0
        try:
            while time.perf_counter() < give_up:
                check_time()
        except TimeIsUp:
            ended.append("stopped")
            raise

    def failing() -> None:
        began.wait(30.0)
        raise stop

    tasks: list[Callable[[], None]] = [failing, endless, endless]
    with pytest.raises(stop):
        side_by_side(tasks)
    assert set(ended) == {"stopped"}
