"""From a plan to sealed cases, on a short stage; and the tool on such a case, by its command line."""

from __future__ import annotations

import json
import tomllib

import pytest

from experiments.concealed.machines.stage import Stage
from experiments.concealed.proof import draw
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
