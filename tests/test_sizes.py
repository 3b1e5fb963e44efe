"""Files stay short enough to be read at once."""

from __future__ import annotations

from pathlib import Path
from statistics import median

import greybox_torch

MOST_LINES = 250
MEDIAN_BELOW = 110


def lines() -> dict[str, int]:
    package = Path(greybox_torch.__file__).parent
    return {file.relative_to(package).as_posix(): len(file.read_text().splitlines()) for file in package.rglob("*.py")}


def test_no_file_is_long() -> None:
    long = {name: count for name, count in lines().items() if count > MOST_LINES}
    assert not long


def test_most_files_are_short() -> None:
    assert median(lines().values()) < MEDIAN_BELOW
