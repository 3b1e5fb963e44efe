"""The line that a finding names: of the method and the key, not of the class."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.checking.test_examine import OUTPUT, B, examined, line_of, rate

# What is changed, what is found, what is to be written, and a part of the line that is named.
FAULTS = {
    "more than one number a sample": (
        rate(" / p.J", " / p.J * torch.ones(2, 1)"),
        "Motor.derivative() returned 'speed' of shape (2, 3) for signals of shape (3,)", "one number", "return {\"speed\": (",
    ),
    "a list": (
        (OUTPUT, "return [x.speed]"), "Motor.output() returned list", "a dictionary with the keys speed", "return [",
    ),
    "declared twice": (
        (B, B + ' \n                  Parameter("k", 1.0, unit="s"),'),
        "parameter 'k' is declared twice", "another name", 'Parameter("k", 1.0, unit="s")',
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_the_line_at_fault(tmp_path: Path, machines: Path, fault: str) -> None:
    """Seen: all three named the line of the class, and said "write: a class of which an object can be made"."""
    change, found, write, line = FAULTS[fault]
    result, text = examined(tmp_path, machines, change)
    (told,) = [f for f in result.findings if f.found == found]
    assert write in told.write and told.line == line_of(text, line)
