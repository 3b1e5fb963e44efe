"""Two verdicts on a case are equal to the last digit, or it is said what changed."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from experiments.verdicts.__main__ import main
from experiments.verdicts.comparison import compared

SCORES = {stage: {"fit": 90.0, "rmse": 0.5} for stage in ("start", "refit", "augmented")}
VERDICT: dict[str, Any] = {
    "mismatch": True,
    "seconds": 3.0,
    "stages": {"preparing": 0.1},
    "confidence": 0.9,
    "evidence": ["one", "two"],
    "effects": [
        {"port": "motor", "mechanism": "gravity", "probability": 0.9, "parameters": {"m": {"value": 1.0, "std": 0.1}}},
        {"port": "arm", "mechanism": "backlash", "probability": 0.8},
    ],
    "fit": [
        {"experiment": "a", "role": "estimation", "output": "y", **SCORES},
        {"experiment": "b", "role": "validation", "output": "y", **SCORES},
    ],
}


@pytest.fixture
def other() -> dict[str, Any]:
    return copy.deepcopy(VERDICT)


def test_seconds_and_stages_alone_do_not_count(other: dict[str, Any]) -> None:
    other["seconds"], other["stages"] = 9.0, {}
    assert compared(VERDICT, other) == []


def test_the_last_digit_counts(other: dict[str, Any]) -> None:
    other["effects"][0]["parameters"]["m"]["value"] = 1.0 + 2e-16
    other["confidence"] = 0.9 + 2e-16
    assert compared(VERDICT, other) == ["gravity at motor: parameters.m.value changed", "1 other fields: confidence"]


def test_names_probabilities_and_fits_that_changed_are_told(other: dict[str, Any]) -> None:
    other["mismatch"] = False
    other["effects"][0]["probability"] = 0.5
    other["effects"][1]["mechanism"] = "end_stop"
    other["fit"][1]["augmented"] = {"fit": 95.5, "rmse": 0.3}
    other["evidence"] = ["one", "three"]
    assert compared(VERDICT, other) == [
        "mismatch: missing -> nothing missing",
        "gone: backlash at arm (0.80)",
        "new: end_stop at arm (0.80)",
        "gravity at motor: probability 0.9 -> 0.5",
        "augmented: 1 of 2 fits, y in b from 90 to 95.5 %",
        "1 other fields: evidence[1]",
    ]


def test_order_roles_and_fits_without_a_number_are_told(other: dict[str, Any]) -> None:
    other["effects"].reverse()
    other["fit"][0]["refit"] = {"fit": None, "rmse": None}
    assert compared(VERDICT, other) == [
        "the effects stand in another order",
        "refit: 1 of 2 fits, y in a from 90 to nothing %",
    ]
    other["fit"][1]["role"] = "estimation"
    assert "fit: other rows (2 -> 2), or other roles" in compared(VERDICT, other)


def test_the_command_ends_with_one_where_something_differs(
    other: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folders = [tmp_path / "before", tmp_path / "after"]
    for folder, cases in zip(folders, ({"same": VERDICT, "gone": VERDICT}, {"same": other}), strict=True):
        for name, verdict in cases.items():
            (folder / name).mkdir(parents=True)
            (folder / name / "verdict.json").write_text(json.dumps(verdict))
    assert main(["compare", *map(str, folders)]) == 1
    assert capsys.readouterr().out.splitlines() == [
        "gone:",
        "    a verdict only before",
        "same: equal",
        "1 of 2 cases are equal",
    ]
    assert main(["compare", *map(str, folders), "--only", "same"]) == 0
    assert main(["compare", *map(str, folders), "--only", "sane"]) == 2
    assert 'neither folder has a verdict on sane (did you mean "same"?)' in capsys.readouterr().err
    assert main(["compare", str(folders[0]), str(tmp_path / "nowhere")]) == 2
    assert "no verdict is in it" in capsys.readouterr().err
