"""How far a fleet has come."""

from __future__ import annotations

import pytest

from greybox_torch.commands.fleet_progress import counting, in_words
from greybox_torch.fleets.progress import Progress
from greybox_torch.fleets.row import Row

DONE, BAD = Row("a", "a.toml", "nothing"), Row("b", "b.toml", "failed")


def test_throughput_and_time_left() -> None:
    state = Progress(10).after(DONE, True, 1.0)
    assert (state.rate, state.seconds_left) == (0.0, None)  # what was kept says nothing about the rest
    state = state.after(DONE, False, 4.0).after(BAD, False, 8.0)
    assert (state.done, state.kept, state.failed) == (3, 1, 1)
    assert (state.rate, state.seconds_left) == (0.25, 28.0)
    assert in_words(state) == "3 of 10 done (1 failed, 1 unchanged), 0.25 a second, about 28 s left"


def test_lines_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with counting("diagnosing [x]") as tell:
        state = Progress(3)
        for k in range(3):
            state = state.after(DONE, False, 10.0 + k)
            tell(state)
    first, *lines = capsys.readouterr().err.splitlines()
    assert first == "diagnosing [x]"
    assert len(lines) == 2  # the second came too soon for a line of its own
    assert lines[0] == "   10.0 s  1 of 3 done, 0.10 a second, about 20 s left  a"
    assert lines[1] == "   12.0 s  3 of 3 done, 0.25 a second  a"
