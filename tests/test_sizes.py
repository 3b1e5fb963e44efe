"""Files stay short enough to be read at once."""

from __future__ import annotations

from pathlib import Path
from statistics import median

import pytest

ROOT = Path(__file__).parents[1]
MOST_LINES = 250
MEDIAN_BELOW = 110


def lines(part: str) -> dict[str, int]:
    return {
        file.relative_to(ROOT).as_posix(): len(file.read_text().splitlines()) for file in (ROOT / part).rglob("*.py")
    }


@pytest.mark.parametrize("part", ["greybox_torch", "tests", "experiments"])
def test_no_file_is_long(part: str) -> None:
    counted = lines(part)
    assert counted
    assert not {name: count for name, count in counted.items() if count > MOST_LINES}


def test_most_files_are_short() -> None:
    assert median(lines("greybox_torch").values()) < MEDIAN_BELOW
