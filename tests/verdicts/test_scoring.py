"""Verdicts against keys, and probabilities against what came true."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.verdicts.calibrate import NAMES, brier, fitted_map, main, mapped, reliability, scored
from experiments.verdicts.scoring import score, score_all
from experiments.verdicts.totals import table
from greybox_torch.diagnosis.contradictions import contradictions

KEY = {
    "effects": ["bias", "friction"],
    "accept": [[["motor", "constant_bias"], ["actuator", "input_bias"]], [["motor", "coulomb_friction"]]],
    "near": [[["motor", "coulomb_asymmetry"]], []],
    "ports": [["motor", "actuator"], ["motor"]],
    "sigma": 0.1,
}


def verdict(*effects: tuple[str, str, float], before: float = 1.0, after: float = 0.5) -> dict[str, Any]:
    found = [{"port": port, "mechanism": mechanism, "probability": p} for port, mechanism, p in effects]
    rows = [("estimation", 9.0, 9.0), ("validation", before, after)]
    fit = [{"role": r, "refit": {"rmse": b}, "augmented": {"rmse": a}} for r, b, a in rows]
    return {"mismatch": bool(effects), "effects": found, "fit": fit, "seconds": 3.0}


def test_findings_take_effects_in_the_verdicts_order_each_once() -> None:
    said = verdict(("motor", "coulomb_asymmetry", 0.5), ("motor", "coulomb_friction", 0.8), ("motor", "gravity", 0.4))
    found = score("c", said, KEY)
    assert found.detected
    assert [(f.right, f.located, f.spurious) for f in found.findings] == [
        (False, True, False),  # a near miss of the bias
        (True, True, False),
        (False, False, True),
    ]
    assert (found.named, found.located, found.spurious) == (1, 2, 1)


def test_a_wrong_headline_takes_the_effect_that_a_later_finding_names() -> None:
    one = {**KEY, "effects": ["bias"], **{k: KEY[k][:1] for k in ("accept", "near", "ports")}}
    found = score("c", verdict(("motor", "gravity", 0.9), ("motor", "constant_bias", 0.6)), one)
    assert [(f.right, f.located, f.spurious) for f in found.findings] == [(False, True, False), (False, False, True)]


def test_an_exact_name_is_what_was_concealed_and_no_look_alike() -> None:
    key = {**KEY, "own": [["actuator", "input_bias"], ["motor", "coulomb_friction"]]}
    for named, exact in ((("motor", "constant_bias"), False), (("actuator", "input_bias"), True)):
        said = verdict((*named, 0.5), ("motor", "coulomb_friction", 0.8))
        assert [(f.right, f.exact) for f in score("c", said, key).findings] == [(True, exact), (True, True)]
        assert [f.exact for f in score("c", said, KEY).findings] == [True, True], "a key that does not say"
    near, spurious = score("c", verdict(("motor", "coulomb_asymmetry", 0.5), ("arm", "gravity", 0.5)), key).findings
    assert not near.exact and not spurious.exact


def test_a_class_is_right_where_any_member_is() -> None:
    said = verdict(("arm", "gravity", 0.4))
    members = [
        {"port": "arm", "mechanism": "gravity", "probability": 0.4},
        {"port": "actuator", "mechanism": "input_bias", "probability": 0.5},
    ]
    said["effects"][0]["one_of"] = {"statement": "something pulls", "probability": 0.9, "members": members}
    (finding,) = score("c", said, KEY).findings
    assert (finding.right, finding.class_right, finding.class_probability) == (False, True, 0.9)


def test_refinements_count_neither_way() -> None:
    said = verdict(("motor", "coulomb_friction", 0.8)) | {
        "refinements": [{"port": "motor", "mechanism": "gravity", "probability": 0.3}]
    }
    assert score("c", said, KEY).spurious == 0


def test_a_free_run_that_overflows_closes_nothing() -> None:
    said = verdict(("motor", "gravity", 0.4))
    said["fit"][1]["augmented"]["rmse"] = None
    scored = score("c", said, KEY)
    assert scored.closed == -np.inf and scored.worse


def test_no_verdict_is_a_miss_that_says_why() -> None:
    missed = score("c", None, KEY, said="exit 3: the matrix is singular", seconds=2.0)
    assert (missed.detected, missed.named, missed.closed) == (False, 0, None)
    text = table([missed])
    assert "| c | bias, friction | exit 3: the matrix is singular | no | 0/2 | 0/2 | 0 |  |" in text
    assert "without a verdict: 1: c (exit 3: the matrix is singular)" in text


def test_contradictions_are_said() -> None:
    said = verdict(("motor", "gravity", 1.2), ("motor", "gravity", 0.4), after=1.1) | {
        "mismatch": False, "schema": "greybox-verdict/2",
    }  # fmt: skip
    said["effects"][1] |= {"size": 0.3, "one_of": {"probability": 0.3}, "parameters": {"m": {"value": None}}}
    assert contradictions(said) == [
        "effects are named, and nothing is said to be missing",
        "the recommended model simulates the validation experiments worse than the re-estimated one",
        "gravity at motor is named twice",
        "gravity at motor: its probability is 1.2",
        "gravity at motor: its size is None",
        "gravity at motor: it is likelier (0.40) than the class that it belongs to (0.30)",
        "gravity at motor: m has no value",
    ]
    assert contradictions(verdict(("motor", "gravity", 0.9))) == contradictions(verdict(after=1.0)) == []


def test_a_near_miss_takes_its_effect() -> None:
    found = score("c", verdict(("motor", "coulomb_asymmetry", 0.5), ("motor", "coulomb_friction", 0.9)), KEY)
    assert [(f.right, f.located) for f in found.findings] == [(False, True), (True, True)]


def test_where_nothing_is_concealed_every_finding_is_spurious() -> None:
    key = {"effects": ["none"], "sigma": 0.1}
    found = score("c", verdict(("motor", "gravity", 0.4)), key)
    assert (found.detected, found.spurious, found.closed) == (False, 1, None)
    assert score("c", verdict(), key).detected


def test_closure_counts_what_is_above_the_noise() -> None:
    found = score("c", verdict(("motor", "gravity", 0.4), before=0.5, after=np.sqrt(0.01 + 0.06)), KEY)
    assert found.closed == pytest.approx(0.5)


def test_a_complete_card_beside_a_key_is_a_case_without_effect(tmp_path: Path) -> None:
    case = tmp_path / "cases" / "drive"
    case.mkdir(parents=True)
    (case / "key.json").write_text(json.dumps(KEY))
    (case / "complete.toml").write_text("")
    for name, said in (("drive", verdict()), ("drive_complete", verdict(("motor", "gravity", 0.7)))):
        (tmp_path / "out" / name).mkdir(parents=True)
        (tmp_path / "out" / name / "verdict.json").write_text(json.dumps(said))
    found = score_all(tmp_path / "cases", tmp_path / "out")
    assert [(s.name, s.effects, s.spurious) for s in found] == [
        ("drive", ("bias", "friction"), 0),
        ("drive_complete", (), 1),
    ]


def test_probabilities_that_mean_what_they_say_are_left_alone() -> None:
    rng = np.random.default_rng(0)
    claimed = rng.uniform(0.05, 0.97, 4000)
    right = (rng.random(4000) < claimed).astype(float)
    a, b = fitted_map(claimed, right)
    assert (a, b) == pytest.approx((0.0, 1.0), abs=0.12)
    for row in reliability(claimed, right):
        assert row["right"] == pytest.approx(row["claimed"], abs=0.06)


def test_probabilities_that_are_too_sure_are_brought_down() -> None:
    rng = np.random.default_rng(1)
    claimed = rng.uniform(0.5, 0.97, 2000)
    right = (rng.random(2000) < 0.5 + 0.5 * (claimed - 0.5)).astype(float)
    weights = fitted_map(claimed[::2], right[::2])
    before, after = brier(claimed[1::2], right[1::2]), brier(mapped(claimed[1::2], weights), right[1::2])
    assert after < before - 0.01
    assert np.all(np.diff(mapped(np.linspace(0.1, 0.97, 20), weights)) > 0)


def test_the_whole_script(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rng = np.random.default_rng(2)
    for k in range(12):
        case, answer = tmp_path / "cases" / f"c{k}", tmp_path / "verdicts" / f"c{k}"
        case.mkdir(parents=True)
        answer.mkdir(parents=True)
        (case / "key.json").write_text(json.dumps(KEY))
        said = verdict(("motor", "coulomb_friction" if rng.random() < 0.7 else "gravity", 0.6 + 0.03 * k))
        members = [{"port": "motor", "mechanism": name} for name in ("gravity", "coulomb_friction")]
        said["effects"][0]["one_of"] = {"probability": 0.97, "members": members}
        (answer / "verdict.json").write_text(json.dumps(said))
    (tmp_path / "cases" / "unanswered").mkdir()
    (tmp_path / "cases" / "unanswered" / "key.json").write_text(json.dumps(KEY))
    assert [s.verdict is None for s in score_all(tmp_path / "cases", tmp_path / "verdicts")] == [*[False] * 12, True]
    main(tmp_path / "out", [tmp_path / "cases", tmp_path / "verdicts"], tmp_path / "page.md")
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((tmp_path / "out" / "calibration.json").read_text())
    named = printed["names"]
    assert named == printed["exact names"], "the keys do not say which of the names they accept was concealed"
    assert named["fitted on"]["findings"] == named["tested on"]["findings"] == 6
    of_classes = printed["classes"]["tested on"]
    assert of_classes["brier"] == pytest.approx(0.03**2) and of_classes["right"] == 1.0
    assert of_classes["reliability"][0]["upper"] == 1.0
    assert of_classes["reliability"][0]["lower"] == pytest.approx(
        0.025 ** (1 / 6)
    )  # Clopper and Pearson, of six of six
    for file in (tmp_path / "out" / "calibration.png", tmp_path / "calibration.png"):
        assert file.stat().st_size > 5000
    page = (tmp_path / "page.md").read_text()
    assert "12 findings of 13 cases" in page and "| classes | 0.9 and 1 | 6 | 0.970 | 6/6" in page


def test_the_map_is_fitted_on_all_folders_but_the_last(tmp_path: Path) -> None:
    folders = []
    for name, found in (("one", "coulomb_friction"), ("two", "coulomb_friction"), ("last", "gravity")):
        for part in ("cases", "verdicts"):
            folders.append(tmp_path / name / part)
            (folders[-1] / "c0").mkdir(parents=True)
        (folders[-2] / "c0" / "key.json").write_text(json.dumps(KEY))
        (folders[-1] / "c0" / "verdict.json").write_text(json.dumps(verdict(("motor", found, 0.6))))
    told = scored(folders, NAMES)
    assert (told["fitted on"]["findings"], told["tested on"]["findings"]) == (2, 1)
    assert told["tested on"]["right"] == 0.0 and told["tested on"]["brier mapped"] > told["tested on"]["brier"]


def test_the_table_counts_by_kind_and_shows_misses() -> None:
    none = {"effects": ["none"], "sigma": 0.1, "outside": []}
    outside = {**KEY, "effects": ["bias"], "outside": [True]}
    cases = [
        score("hit", verdict(("actuator", "input_bias", 0.8)), outside),
        score("miss", verdict(), KEY),
        score("clean", verdict(), none),
        score("alarm", verdict(("motor", "gravity", 0.4)), none),
    ]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table(cases).splitlines()]
    by_name = {row[0]: row[1:] for row in rows}
    assert by_name["miss"][1:5] == ["nothing missing", "no", "0/2", "0/2"]
    assert by_name["alarm"][2] == "no" and by_name["clean"][2] == "yes"
    assert by_name["without effect"][:2] == ["2", "1/2"] and by_name["without effect"][4] == "1"
    assert by_name["outside the library"][:4] == ["1", "1/1", "1/1", "1/1"]
    assert by_name["two effects or more"][:4] == ["1", "0/1", "0/2", "0/2"]
    assert by_name["all"][:3] == ["4", "2/4", "1/3"]
