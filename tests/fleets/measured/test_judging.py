"""What a fleet's result is worth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from experiments.fleets.judging import judged, same_verdict
from experiments.fleets.page import page
from experiments.fleets.plan import Planned
from experiments.fleets.running import Fleet, FleetFailed

DATES = tuple(f"2026-{month:02d}-01" for month in range(1, 9))
APPEARS = Planned("a", "coulomb", 0.02, DATES, (0.0,) * 4 + (0.1,) * 4, (0.05,) * 8, changed=4)
QUIET = Planned("q", "", 0.02, DATES, (0.0,) * 8, (0.05,) * 8)


def row(machine: str, date: str, mechanism: str) -> dict[str, Any]:
    answer = "named" if mechanism else "nothing"
    return {
        "machine": machine,
        "recorded": date,
        "answer": answer,
        "port": "rotor" if mechanism else "",
        "mechanism": mechanism,
    }


def result(
    *, found: str = "coulomb_friction", changes: tuple[tuple[str, str], ...] = (("a", DATES[5]),)
) -> dict[str, Any]:
    rows = [row("q", date, "") for date in DATES]
    rows += [row("a", date, found if size else "") for date, size in zip(DATES, APPEARS.sizes, strict=True)]
    told = [{"machine": machine, "what": "presence", "date": date} for machine, date in changes]
    return {"machines": rows, "changes": told}


def test_all_right() -> None:
    """A date that is one recording off counts as right."""
    told = judged([APPEARS, QUIET], result())
    assert told["wrong"] == []
    assert (told["named"], told["with_effect"], told["quiet"], told["without"]) == (4, 4, 12, 12)
    assert (told["dated"], told["changed"], told["false_changes"], told["machines"]) == (1, 1, 0, 2)


def test_what_is_wrong_is_counted_and_told() -> None:
    told = judged([APPEARS, QUIET], result(found="quadratic_drag", changes=(("a", DATES[7]), ("q", DATES[4]))))
    assert (told["named"], told["dated"], told["false_changes"]) == (0, 0, 2)
    assert "a 2026-05-01: coulomb of size 0.1, said quadratic_drag at rotor" in told["wrong"]
    assert "q: presence said to change before 2026-05-01" in told["wrong"]
    assert "a: its change before 2026-05-01 was not dated" in told["wrong"]


def test_verdicts_are_compared_but_for_time() -> None:
    verdict = {"sentence": "x", "effects": [{"size": 0.5}], "seconds": 1.0, "stages": {"searching": 1.0}}
    assert same_verdict(verdict, {**verdict, "seconds": 2.0, "stages": {}})
    assert not same_verdict(verdict, {**verdict, "effects": [{"size": 0.5000001}]})


def test_the_page() -> None:
    measured = {
        "about": {"commit": "abc", "date": "2026-11-21", "processor": "P", "cores": "2"},
        "choices": {"machines": 2, "first": None, "recordings": 8, "samples": 300, "workers": 2, "seed": 0},
        "judged": judged([APPEARS, QUIET], result(changes=())),
        "interrupted": {
            "data_sets": 16,
            "rows": 16,
            "failed": [],
            "done_before_the_restart": 9,
            "of_them_done_again": 0,
            "worker_memory": 400.0,
            "own_memory": 150.0,
            "diagnosing_seconds": [1.0, 2.0, 5.0],
            "stages": {"searching": 0.5},
        },
        "alone": {"compared": 3, "different": [], "processor": [4.0, 5.0]},
        "throughput": [
            {"workers": n, "per_second": 0.5 * n, "processor": 30.0, "data_sets": 10, "load": 2.0} for n in (1, 2)
        ],
        "growth": [{"samples": 600, "processor": 4.0, "seconds": 4.0, "memory": 400.0}],
    }
    text = page(measured)
    assert "| verdicts that differ from those one by one | 0 of 3 compared |" in text
    assert "| machines that changed: dated within one recording | 0 of 1 (0.0 %) |" in text
    assert "1.000 (load 2.0): 2.00 times" in text
    assert "- a: its change before 2026-05-01 was not dated" in text


def test_a_fleet_that_cannot_begin(tmp_path: Path) -> None:
    with Fleet(tmp_path / "nowhere", tmp_path / "out", 1) as fleet, pytest.raises(FleetFailed, match="exit code 2"):
        fleet.wait_until(lambda: False)
