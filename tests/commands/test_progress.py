"""The course of a training where there is no terminal."""

from __future__ import annotations

import pytest

from greybox_torch.commands.progress import training


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
    assert "s left" in lines[1] and "left" not in lines[3]
