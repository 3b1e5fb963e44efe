"""Scores, intervals, confusion, figures and the page of a proof whose verdicts are written by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom

from experiments.concealed.proof import __main__ as command
from experiments.concealed.proof.confusion import kind, matrix
from experiments.concealed.proof.figures import draw_all
from experiments.concealed.proof.promises import promises, scored_cases
from experiments.concealed.proof.reasons import reasons
from experiments.verdicts.rates import Rate
from experiments.verdicts.running import sentence
from experiments.verdicts.scoring import Scored, score
from tests.concealed.proof.by_hand import ANSWERS, VERDICTS, answer, verdict

ENTRIES = {name: {"said": "said", "seconds": 2.0, "sha256": "x"} for name in ANSWERS}


@pytest.fixture
def found() -> list[Scored]:
    return scored_cases(ANSWERS, VERDICTS, ENTRIES)


def test_clopper_pearson_at_its_ends_and_against_a_published_value():
    assert Rate(0, 30).interval == pytest.approx((0.0, 1.0 - 0.025 ** (1 / 30)))
    assert Rate(30, 30).interval == pytest.approx((0.025 ** (1 / 30), 1.0))
    assert Rate(4, 20).interval == pytest.approx((0.0573, 0.4366), abs=1e-4)  # Newcombe 1998, table I
    assert Rate(0, 0).interval == (0.0, 1.0)
    assert str(Rate(0, 0)) == "none"


@given(cases=st.integers(1, 60), share=st.floats(0.01, 0.99))
def test_clopper_pearson_covers_at_least_its_level(cases: int, share: float):
    intervals = [Rate(k, cases).interval for k in range(cases + 1)]
    covered = sum(binom.pmf(k, cases, share) for k, (low, high) in enumerate(intervals) if low <= share <= high)
    assert covered >= 0.95 - 1e-9


def test_scores_of_the_cases(found: list[Scored]):
    by_name = {r.name: r for r in found}
    assert [r.name for r in found if r.right] == ["c000", "c001", "c003"]
    assert (by_name["c002"].detected, by_name["c002"].located, by_name["c002"].named) == (True, 1, 0)
    assert (by_name["c004"].detected, by_name["c004"].named) == (False, 0)
    assert (by_name["c005"].named, by_name["c005"].spurious) == (1, 1)


def test_with_several_outputs_each_has_its_own_floor():
    key = answer("pendulum", ("gravity",)) | {"sigma": {"angle": 0.1, "speed": 1.0}}
    said = verdict("pendulum", ("pivot", "gravity", 0.9), before=2.0, after=0.1)
    for fit in said["fit"]:
        if fit["output"] == "speed":
            fit["refit"]["rmse"], fit["augmented"]["rmse"] = np.sqrt(2.0), np.sqrt(1.25)
    closed = score("c", said, key).closed
    assert closed == pytest.approx(1.0 - np.sqrt((0.0 + 0.25) / (399.0 + 1.0)))


def test_promises_count_moderate_effects_by_the_visibility_of_the_key(found: list[Scored]):
    kept = {p.what: p for p in promises(found)}
    assert kept["moderate and stronger effects detected"].measured.startswith("3/3")
    assert kept["moderate and stronger effects named"].measured.startswith("2/4")
    assert kept["moderate and stronger effects named"].kept is False
    assert kept["spurious among all findings"].measured.startswith("1/5")
    assert kept["outside the library: `unknown` at the right port"].kept is True
    assert kept["false alarms without an effect"].kept is None  # none in one case is not none in thirty
    brier = np.mean([(0.9 - 1) ** 2, 0.7**2, (0.9 - 1) ** 2, (0.95 - 1) ** 2, 0.4**2])
    assert kept["Brier score of the probabilities"].measured.startswith(f"{brier:.3f} (")


def test_brier_score_beside_is_that_of_the_classes():
    said = verdict("stage", ("carriage", "constant_bias", 0.5))
    members = [{"port": "actuator", "mechanism": "input_bias", "probability": 0.4}]
    said["effects"][0]["one_of"] = {"probability": 0.9, "members": members}
    row = scored_cases({"c": ANSWERS["c004"]}, {"c": said}, {"c": ENTRIES["c004"]})
    kept = {p.what: p for p in promises(row)}
    assert kept["Brier score of the probabilities"].measured == "0.250 (0.010 of the answers, 0.010 of the classes)"


def test_crashes_contradictions_and_worse_models_are_promised_to_be_none(found: list[Scored]):
    kept = {p.what: (p.measured, p.kept) for p in promises(found)}
    assert kept["cases without a verdict"] == ("0", True)
    worse = verdict("arm", ("gear_spring", "backlash", 0.7), after=1.5)
    rows = scored_cases(
        {"c": ANSWERS["c002"], "d": ANSWERS["c002"]},
        {"c": worse, "d": None},
        {"c": ENTRIES["c002"], "d": ENTRIES["c002"]},
    )
    kept = {p.what: (p.measured, p.kept) for p in promises(rows)}
    assert kept["cases without a verdict"] == ("1, d", False)
    assert kept["validation worse than the re-estimated model's"] == ("1, c", False)
    assert kept["verdicts that contradict themselves"] == ("1, c", False)


def test_silence_by_the_time_limit_is_told():
    said = verdict("arm") | {"complete": False}
    row = scored_cases({"c": ANSWERS["c000"]}, {"c": said}, {"c": ENTRIES["c000"]})
    assert row[0].cut_short
    assert promises(row)[0].measured.endswith("1 silent only because the time limit stopped the search")
    assert sentence(said) == "no answer before the time limit"
    assert sentence(verdict("arm")) == "nothing missing"


def test_something_without_a_name_is_not_nothing():
    said = verdict("arm") | {"mismatch": True}
    row = scored_cases({"c": ANSWERS["c002"]}, {"c": said}, {"c": ENTRIES["c002"]})[0]
    assert row.detected and not row.right
    assert sentence(said) == "something missing, without a name"
    assert "found missing, but not what" in reasons(row)


def test_one_false_alarm_breaks_the_promise():
    alarmed = scored_cases(
        {"c": ANSWERS["c000"]}, {"c": verdict("arm", ("motor", "gravity", 0.6))}, {"c": ENTRIES["c000"]}
    )
    assert promises(alarmed)[0].kept is False


def test_no_verdict_is_a_miss_and_no_case_is_not_measured():
    missed = scored_cases(
        {"c001": ANSWERS["c001"]}, {"c001": None}, {"c001": {"said": "no verdict after 240 s", "seconds": 240.0}}
    )
    assert (missed[0].detected, missed[0].named, missed[0].right) == (False, 0, False)
    assert reasons(missed[0]) == ["no verdict: no verdict after 240 s"]
    kept = {p.what: p.kept for p in promises(missed)}
    assert kept["moderate and stronger effects detected"] is False
    assert kept["false alarms without an effect"] is None


def test_reasons_name_what_was_wrong(found: list[Scored]):
    said = {r.name: "; ".join(reasons(r)) for r in found}
    assert said["c000"] == said["c001"] == ""
    assert said["c002"] == "nonlinear_stiffness at gear_spring is a near miss; the place is right"
    assert "weak: 3.0 times the floor" in said["c004"] and "nothing was found" in said["c004"]
    assert "sensor_gain at sensor.speed is spurious" in said["c005"]
    assert "1 of 2 effects without a finding" in said["c005"]


def test_reasons_tell_of_alternatives_of_what_the_data_hardly_show_and_of_the_time_limit():
    said = verdict("stage", ("carriage", "gravity", 0.5), before=0.12)
    said["effects"][0]["alternatives"] = [{"port": "carriage", "mechanism": "coulomb_friction", "probability": 0.3}]
    said["complete"] = False
    row = scored_cases({"c": ANSWERS["c001"]}, {"c": said}, {"c": ENTRIES["c001"]})[0]
    text = "; ".join(reasons(row))
    assert "coulomb_friction at carriage was held possible (0.30)" in text
    assert "leaves 1.2 times the floor there" in text
    assert "stopped by the time limit" in text


def test_confusion_has_twins_on_the_diagonal_and_misses_beside_it(found: list[Scored]):
    labels, columns, counts = matrix(found)
    assert counts.sum() == 7  # one for nothing concealed, six effects; the spurious finding stands for the missed one
    cell = {(a, b): counts[i, j] for i, a in enumerate(labels) for j, b in enumerate(columns)}
    assert cell["body: coulomb_friction", "body: coulomb_friction"] == 1
    assert cell["coupling: backlash", "coupling: nonlinear_stiffness"] == 1
    assert cell["actuator: input_bias", "nothing"] == 1
    assert cell["actuator: actuator_deadzone", "sensor: sensor_gain"] == 1
    assert cell["nothing", "nothing"] == 1
    assert [kind(p) for p in ("motor", "gear_spring", "actuator", "sensor.speed")] == [
        "body",
        "coupling",
        "actuator",
        "sensor",
    ]


def test_figures_are_drawn_where_there_is_something_to_draw(found: list[Scored], tmp_path: Path):
    from matplotlib import image

    assert draw_all(found, tmp_path) == ["confusion.png", "strength.png", "closure.png", "reliability.png"]
    for file in tmp_path.glob("*.png"):
        picture = image.imread(file)
        assert picture.shape[0] > 200 and np.ptp(picture[..., :3]) > 0.5
    assert draw_all([r for r in found if not r.effects], tmp_path) == ["confusion.png"]


def test_the_command_writes_results_figures_and_page_and_goes_on_without_the_tool(tmp_path: Path, by_hand, capsys):
    page = tmp_path / "docs" / "proof.md"
    arguments = ["--set", "quick", "--seed", "7", "--out", str(tmp_path / "run"), "--page", str(page)]
    assert command.main(arguments) == 0
    text = page.read_text()
    for part in (
        "seed 7",
        "## What failed, and why",
        "| c002 | arm | backlash |",
        "near miss",
        "## Against other tools",
        "NOT KEPT",
    ):
        assert part in text
    results = json.loads((page.parent / "proof" / "results.json").read_text())
    assert results["seed"] == 7 and len(results["cases"]) == 6
    for name in ("confusion", "strength", "closure", "reliability"):
        assert f"proof/{name}.png" in text
        assert (page.parent / "proof" / f"{name}.png").stat().st_size > 5000
    first = len(by_hand())
    (tmp_path / "run" / "against").mkdir()
    (tmp_path / "run" / "against" / "against.md").write_text("| tool | closed |\n")
    assert command.main(arguments) == 0
    assert len(by_hand()) == first
    assert "| tool | closed |" in page.read_text()
    assert "page: " in capsys.readouterr().out


def test_mistakes_at_the_command_end_with_two(tmp_path: Path, by_hand, capsys):
    out = ["--out", str(tmp_path)]
    assert command.main(["--set", "quick", "--seed", "7", *out]) == 0
    assert command.main(["--set", "quick", "--seed", "8", *out]) == 2
    assert "error:" in capsys.readouterr().err
    for wrong in (["--seed", "-1"], ["--workers", "0"], ["--set", "slow"]):
        with pytest.raises(SystemExit) as stop:
            command.main([*wrong, *out])
        assert stop.value.code == 2
