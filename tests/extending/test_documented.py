"""The examples of docs/howto/extending.md are the ones that the tests try."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import greybox_torch as gt
from greybox_torch.data.readers import READERS
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.report.sections.order import SECTIONS

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "extending.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S)


def test_there_is_an_example_of_each() -> None:
    assert len(EXAMPLES) == 4


@pytest.mark.parametrize("number", range(len(EXAMPLES)))
def test_it_runs_as_written(run_file, number: int) -> None:
    before = len(LIBRARY) + len(READERS) + len(SECTIONS)
    module = run_file(f"example_{number}.py", EXAMPLES[number])
    tank = getattr(module, "Tank", None)
    assert len(LIBRARY) + len(READERS) + len(SECTIONS) == before + (0 if tank else 1)
    assert tank is None or tank().values() == {"A": 0.5, "R": 100.0}


def test_the_sections_are_those_that_it_names() -> None:
    named = re.search(r"The sections are `([a-z ]+)`", PAGE.read_text())
    assert named is not None and named[1].split() == list(SECTIONS)


def test_what_it_calls_is_public() -> None:
    for name in set(re.findall(r"\bgt\.(\w+)", PAGE.read_text())):
        assert name in gt.__all__
