"""The benchmark of gradients on a task small enough for a test: the ways agree, and the page says what was measured."""

from __future__ import annotations

from pathlib import Path

import pytest

from experiments.gradients.measure import measure
from experiments.gradients.page import write
from experiments.gradients.task import KEPT, WAYS


@pytest.fixture(scope="module")
def rows() -> list[dict]:
    return [{"way": way, "length": n, **measure(way, n, 2, 2, 1)} for n in (6, 12) for way in WAYS]


def test_every_way_finds_the_derivative(rows: list[dict]) -> None:
    for row in rows:
        assert 0 <= row["error"] < 1e-4
        assert row["inconsistency"] < (1e-4 if row["way"] == "odeint_adjoint" else 1e-7)
        assert row["seconds"] > 0 and row["memory"] >= 0


def test_page(rows: list[dict], tmp_path: Path) -> None:
    machine = {"commit": "abc1234", "processor": "one"}
    result = {"windows": 2, "weights": 7, "quick": True, "repeats": 1, "machine": machine, "rows": rows}
    write(tmp_path, result)
    text = (tmp_path / "gradients.md").read_text()
    assert all(f"`{way}`" in text for way in (*WAYS, KEPT))
    assert "the numbers mean nothing" in text and "| commit | abc1234 |" in text
    assert text.count("| 6 |") == text.count("| 12 |") == 4
    assert (tmp_path / "gradients.png").stat().st_size > 10_000
