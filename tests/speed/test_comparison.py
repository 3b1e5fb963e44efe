"""The measuring and the writing: medians, verdicts, tables, the figure, and rows that cannot be measured."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from experiments.speed import rows, timing
from experiments.speed.adam import descend, our_gradient
from experiments.speed.plot import draw_growth
from experiments.speed.records import NAMES, arm_values, published, simulated_problem
from experiments.speed.row import Entry, Row, Target, skipped
from experiments.speed.rows import growth, hypotheses, long_record
from experiments.speed.rows.robustness import drawn
from experiments.speed.settings import Settings, header
from experiments.speed.timing import Timing, interleaved
from experiments.speed.writers import duration, markdown, write
from greybox_torch import load_dataset

ROW = Row(
    "growth",
    "Growth",
    entries=(Entry("ours", 0.0123, 2.0, True, "remark"), Entry("theirs", None)),
    targets=(Target("faster than theirs", "at least", 3.0, 2.0), Target("slope", "at most", 1.05, 1.0, unit="")),
    agreement="1e-12 apart",
    curves={"ours": [(1e4, 0.01), (1e5, 0.1)], "theirs": [(1e4, 0.1), (1e5, 1.2)]},
)


@pytest.fixture
def uncollected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Garbage of thousands of tests takes a second to collect, each time."""
    monkeypatch.setattr(timing.gc, "collect", lambda: 0)


def test_timing_takes_turns_and_the_median(uncollected: None) -> None:
    calls: list[str] = []
    times = interleaved({"a": lambda: calls.append("a"), "b": lambda: calls.append("b")}, repeats=1)
    assert calls == ["a", "b"] * 6, "one call each that is not timed, then at least five in turn"
    assert all(len(t.seconds) == 5 for t in times.values())
    assert Timing((3.0, 1.0, 2.0, 9.0, 8.0)).median == 3.0


def test_timing_measures_the_call(uncollected: None) -> None:
    assert interleaved({"sleep": lambda: time.sleep(0.01)})["sleep"].median >= 0.01


@pytest.mark.parametrize(
    ("relation", "measured", "met"),
    [
        ("at least", 3.0, True),
        ("at least", 2.9, False),
        ("at most", 3.0, True),
        ("at most", 3.1, False),
        ("at least", float("nan"), False),
        ("at least", None, None),
    ],
)
def test_targets(relation, measured, met) -> None:
    assert Target("", relation, 3.0, measured).met is met


def test_a_target_is_missed_where_the_results_differ() -> None:
    target = Target("", "at least", 3.0, 5.0, failed_condition="the gradients differ")
    assert target.met is False and "differ" in target.verdict


@pytest.mark.parametrize(
    ("seconds", "text"), [(None, "–"), (0.00123, "1.23 ms"), (1.5, "1.5 s"), (150.0, "2.5 min"), (9000.0, "2.5 h")]
)
def test_durations(seconds, text) -> None:
    assert duration(seconds) == text


def test_what_is_written(tmp_path: Path) -> None:
    write(tmp_path, {"processor": "some"}, [ROW, skipped("estimation", "Estimation", "recordings are not here")])
    found = json.loads((tmp_path / "results.json").read_text())
    assert found["header"] == {"processor": "some"}
    assert [t["met"] for t in found["rows"][0]["targets"]] == [False, True]
    page = (tmp_path / "results.md").read_text()
    assert "| Growth | faster than theirs: ≥ 3× | 2× | missed |" in page
    assert "| **ours** | 12.3 ms | 2 s | remark |" in page
    assert "skipped: recordings are not here" in page


def test_the_figure(tmp_path: Path) -> None:
    draw_growth(ROW, tmp_path / "growth.png")
    assert (tmp_path / "growth.png").read_bytes().startswith(b"\x89PNG")


def test_slope_of_a_power_law() -> None:
    assert growth.slope([(10.0, 2.0), (100.0, 20.0), (1000.0, 200.0)]) == pytest.approx(1.0)


def test_header_names_the_machine_and_the_libraries() -> None:
    found = header()
    assert {"date", "commit", "processor", "cores", "torch", "jax", "numba"} <= set(found)
    assert markdown(found, []).count("\n") > len(found)


@pytest.mark.parametrize("key", rows.KEYS)
def test_a_row_says_what_it_lacks(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows, "missing_peers", list)
    monkeypatch.setattr(rows, "recordings_present", lambda: False)
    module = __import__(f"experiments.speed.rows.{key}", fromlist=["NEEDS"])
    if not (module.NEEDS.peers or module.NEEDS.recordings):
        pytest.skip("this row needs nothing that can be absent")
    row = rows.measure(key, Settings(quick=True), lambda text: None)
    assert "[peers]" in row.skipped or "recordings" in row.skipped
    assert row.title == module.TITLE and not row.entries


def test_a_hundred_columns_are_offered() -> None:
    from greybox_torch.diagnosis.screen.candidates import candidates
    from greybox_torch.estimate.shifted_states import shifted_states
    from greybox_torch.estimate.surroundings import survey
    from greybox_torch.simulation.simulator import Simulator

    problem = simulated_problem(4, 1000)
    around = survey(problem.model, problem, Simulator.of(problem.model))
    chosen = hypotheses.chosen(
        candidates(problem.model, shifted_states(problem.model, problem), around, flexible=False), around, 100
    )
    assert sum(len(p.directions) for a in chosen for p in a.mechanism.probes(around[a.port])) == 100


def test_drawn_start_values_keep_to_bounds_and_constraints() -> None:
    problem, rng = simulated_problem(1, 1000), np.random.default_rng(0)
    for _ in range(50):
        start = drawn(problem, rng)
        factors = start.values / problem.values
        assert problem.admissible(start.values)
        assert ((factors >= 0.5 - 1e-12) & (factors <= 2 + 1e-12)).all()
        assert factors[list(problem.names).index("J")] == 1.0


def test_adam_goes_down() -> None:
    problem = simulated_problem(1, 1000)
    problem = problem.with_values(problem.values * np.where(problem.free, 1.05, 1.0))
    task = published(problem)
    gradient = our_gradient(problem, task)
    assert descend(gradient, task, 1e-9, most=20).mse < gradient(task.start)[0]


def test_a_long_record_lacks_what_its_card_fixes(tmp_path: Path) -> None:
    data = load_dataset(long_record.recorded(tmp_path, 600, 300))
    assert [(r.role, len(r.time)) for r in data.recordings] == [("estimation", 600), ("validation", 300)]
    missing = data.parameters["k_g3"]
    assert (missing.value, missing.fixed) == (0.0, True)
    others = {name: entry.value for name, entry in data.parameters.items() if name != "k_g3"}
    assert others == {n: v for n, v in zip(NAMES, arm_values(), strict=True) if n != "k_g3"}
    assert arm_values()[NAMES.index("k_g3")] > 0.0
