"""The course of a computation where there is no terminal."""

from __future__ import annotations

import pytest

from greybox_torch.commands import progress
from greybox_torch.commands.progress import estimating, news, training


def test_lines_with_the_time_left(capsys: pytest.CaptureFixture[str]) -> None:
    with training("training [a] hybrid") as tell:
        tell("windows of 20 samples", 0.25, "epoch 1  loss 0.9")
        tell("windows of 20 samples", 0.3, "epoch 2  loss 0.8")
        tell("windows of 40 samples", 0.5, "epoch 1  loss 0.7")
        tell("scoring", 1.0, "")
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition(" s  ")[2].partition("  about")[0] for line in lines] == [
        "training [a] hybrid",
        "windows of 20 samples  epoch 1  loss 0.9",  # the next epoch comes too soon for a line of its own
        "windows of 40 samples  epoch 1  loss 0.7",
        "scoring",
    ]
    assert "left" not in "".join(lines)


def test_no_time_is_told_before_it_can_be(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: "epoch 1 … about 1040 s left" of a training of 6 s, as the estimate of the physics was counted to the first epoch."""
    clock = iter([0.0, 0.0, 3.0, *(3.0 + 0.01 * k for k in range(1, 30)), 9.0])
    monkeypatch.setattr(progress.time, "perf_counter", lambda: next(clock))
    with training("training a hybrid") as tell:
        for epoch in range(1, 31):
            tell("windows of 20 samples", epoch / 300, f"epoch {epoch}")
        tell("windows of 40 samples", 0.4, "epoch 1")  # the rest was not needed, and start states took long
    lines = capsys.readouterr().err.splitlines()
    assert "epoch 1" in lines[1] and "left" not in lines[1]
    assert lines[-1].endswith("windows of 40 samples  epoch 1  about 2 s left for the epochs")


def test_on_a_terminal_iterations_are_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seen: more than thirty lines of descents that pushed away what had been said before them."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    with estimating() as tell:
        tell("J and k: only their ratio is determined")
        for iteration in range(1, 41):
            tell(f"whole records, descent 5, iteration {iteration}: mean squared error {0.9**iteration:.3g}")
    told = capsys.readouterr().err
    assert "J and k: only their ratio is determined" in told
    assert told.count("mean squared error") < 20


def test_iterations_are_a_few_lines_in_a_log(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: 300 lines "whole records, descent 3 …, iteration …" of a fit of 25 s, which buried the rest."""
    clock, told = iter([0.1 * k for k in range(1000)]), []
    monkeypatch.setattr(progress.time, "perf_counter", lambda: next(clock))
    tell = news(told.append)
    for iteration in range(1, 401):  # 40 s
        tell(f"whole records, iteration {iteration}: mean squared error {1 / iteration:.6g}")
    tell("windows of 20 samples, iteration 1: mean squared error 0.35")
    tell("windows of 20 samples, iteration 2: mean squared error 0.34")
    tell("interrupted: the estimate is kept")
    assert [line.partition(":")[0] for line in told] == [
        "whole records, iteration 1",
        "whole records, iteration 51",  # after five seconds
        "whole records, iteration 151",  # after ten more
        "whole records, iteration 351",  # after twenty more
        "whole records, iteration 400",
        "windows of 20 samples, iteration 1",
        "windows of 20 samples, iteration 2",
        "interrupted",
    ]
