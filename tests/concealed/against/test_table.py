"""The table counts what was said: right, wrong, nothing; closed, worse than before, failed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from experiments.concealed.against.table import compared, table

KEYS: dict[str, dict[str, Any]] = {
    "a": {
        "effects": ["drag"],
        "accept": [[["rotor", "quadratic_drag"]]],
        "near": [[]],
        "ports": [["rotor"]],
        "sigma": 0.0,
    },
    "b": {"effects": ["none"], "accept": [[]], "near": [[]], "ports": [[]], "sigma": 0.0},
}


def said(name: str, *mechanisms: str, before: float = 1.0, after: float | None = 0.5) -> dict[str, Any]:
    row = {"role": "validation", "refit": {"rmse": before}, "augmented": {"rmse": after}}
    effects = [{"port": "rotor", "mechanism": m, "probability": 1.0} for m in mechanisms]
    return {
        "mismatch": bool(mechanisms),
        "effects": effects,
        "fit": [row],
        "seconds": 2.0,
        "can_name": name != "network",
    }


@pytest.fixture
def out(tmp_path: Path) -> Path:
    results = {
        "a": {"sindy": said("sindy", "quadratic_drag", "gravity"), "network": said("network", after=None)},
        "b": {"sindy": said("sindy", "gravity"), "network": {"failed": "it overflows", "seconds": 1.0}},
    }
    for case, by_method in results.items():
        (tmp_path / "keys" / case).mkdir(parents=True)
        (tmp_path / "keys" / case / "key.json").write_text(json.dumps(KEYS[case]))
        (tmp_path / "out" / case).mkdir(parents=True)
        for method, result in by_method.items():
            (tmp_path / "out" / case / f"{method}.json").write_text(json.dumps(result))
    return tmp_path


def test_counts(out: Path) -> None:
    rows = compared(out / "keys", out / "out", None)
    text = table(rows)
    assert "| one effect | sparse regression (pysindy), as regressed | 1/1 | 1 | 0/1 | 0.50 | 0/1 | 2 |" in text
    assert (
        "| one effect | neural residual | cannot name | cannot name | cannot name | -inf | 1/1 | 2 |" in text
    )  # it overflowed
    assert "| without effect | sparse regression (pysindy), as regressed |  | 1 | 0/1 |  |  | 2 |" in text
    assert "**quadratic_drag** at rotor, gravity at rotor; 0.50" in text
    assert "- b, neural residual: it overflows" in text


def test_something_without_a_name_is_not_nothing(out: Path) -> None:
    file = out / "out" / "a" / "sindy.json"
    file.write_text(json.dumps({**said("sindy"), "mismatch": True}))
    text = table(compared(out / "keys", out / "out", None))
    assert "| one effect | sparse regression (pysindy), as regressed | 0/1 | 0 | 0/1 | 0.50 | 0/1 | 2 |" in text
    assert "| a | drag | something missing, without a name; 0.50 |" in text


def test_only_cases_on_which_all_methods_have_a_result_are_compared(out: Path) -> None:
    (out / "out" / "a" / "network.json").unlink()
    assert {row.case for row in compared(out / "keys", out / "out", None)} == {"b"}


def test_without_results_there_are_no_rows(out: Path) -> None:
    assert compared(out / "keys", out / "elsewhere", None) == []
