"""From a plan to sealed cases, on a short stage; and the tool on such a case, by its command line."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

from experiments.concealed.machines.stage import Stage
from experiments.concealed.proof import diagnosing, draw
from experiments.concealed.proof.files import sha256
from experiments.concealed.proof.plan import Planned
from experiments.concealed.trial_files import digest


class ShortStage(Stage):
    samples = 600
    pre_roll = 0.1


PLANNED = [
    Planned("excitation", "stage", ("coulomb",), ("moderate",), 0, estimation="estimation"),
    Planned("excitation", "stage", ("coulomb",), ("moderate",), 0, estimation="validation3"),
    Planned("noise", "stage", ("input_bias",), ("moderate",), 1, noise=10.0),
    Planned("none", "stage", (), (), 2),
    Planned("noise", "stage", ("input_bias",), ("moderate",), 1),
    Planned("two effects", "stage", ("constant_bias", "deadzone"), ("weak", "moderate"), 3),
]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("drawn")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(draw, "MACHINES", {"stage": ShortStage()})
        keys = draw.draw_cases(PLANNED, 11, folder / "first")
        again = draw.draw_cases(PLANNED[3:4], 11, folder / "again")
    return folder, keys, again


def test_cases_of_one_draw_differ_in_what_is_varied_alone(drawn):
    folder, keys, _ = drawn
    first, second = folder / "first" / "c000", folder / "first" / "c001"
    for i in (1, 2, 3, 4):
        assert (first / f"experiment{i}.csv").read_bytes() == (second / f"experiment{i}.csv").read_bytes()
    roles = [
        [e["role"] for e in tomllib.loads((f / "dataset.toml").read_text())["experiment"]] for f in (first, second)
    ]
    assert roles == [["estimation", *["validation"] * 3], [*["validation"] * 3, "estimation"]]
    assert keys["c000"]["switches"] == keys["c001"]["switches"]


def test_more_noise_makes_the_same_effect_less_visible(drawn):
    _, keys, _ = drawn
    noisy, usual = keys["c002"], keys["c004"]
    assert (noisy["noise"], usual["noise"]) == (10.0, 1.0)
    assert noisy["switches"] == usual["switches"]
    assert noisy["sigma"] > 2.0 * usual["sigma"]
    assert noisy["visibility"] < 0.6 * usual["visibility"]


def test_keys_hold_what_the_score_needs(drawn):
    _, keys, _ = drawn
    assert list(keys) == [f"c{i:03d}" for i in range(6)]
    assert keys["c003"]["effects"] == ["none"]
    assert keys["c005"]["effects"] == ["constant_bias", "deadzone"]
    assert len(keys["c005"]["accept"]) == len(keys["c005"]["ports"]) == 2
    json.dumps(keys, allow_nan=False)


def test_a_case_depends_on_seed_and_number_alone(drawn):
    folder, _, again = drawn
    assert digest(folder / "again" / "c000") == digest(folder / "first" / "c003")
    assert list(again) == ["c000"]


def test_the_tool_is_called_as_a_user_would(drawn, tmp_path: Path):
    case = drawn[0] / "first" / "c003"
    before = digest(case)
    entry = diagnosing._diagnose(case, tmp_path / "out", 5.0)
    verdict = tmp_path / "out" / "verdict.json"
    assert entry["sha256"] == sha256(verdict.read_bytes())
    assert entry["said"] == diagnosing.sentence(json.loads(verdict.read_text()))
    assert digest(case) == before
    assert [f.name for f in tmp_path.iterdir()] == ["out"]  # nothing is left of the attempt's own folder


def test_failures_and_endless_runs_go_on_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "dataset.toml").write_text('name = "no experiments"\n')
    entry = diagnosing._diagnose(tmp_path / "case", tmp_path / "out", 5.0)
    assert entry["sha256"] is None
    assert entry["said"].startswith("exit 2: ")
    assert not (tmp_path / "out").exists()
    monkeypatch.setattr(diagnosing, "GRACE", -5.99)
    entry = diagnosing._diagnose(tmp_path / "case", tmp_path / "out", 10.0)
    assert entry["said"].startswith("no verdict after")
