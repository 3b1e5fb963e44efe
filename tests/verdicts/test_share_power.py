"""By which power a finding and its rivals share a probability."""

from __future__ import annotations

from pathlib import Path

import pytest

from experiments.verdicts.scoring import score
from experiments.verdicts.share_power import main, raised, scored_at

RIVAL = {"port": "arm", "mechanism": "coulomb_friction", "probability": 0.37}
EFFECT = {
    "port": "motor",
    "mechanism": "coulomb_friction",
    "probability": 0.6,
    "alternatives": [RIVAL],
    "one_of": {"probability": 0.97, "members": [{**RIVAL, "probability": 0.6, "port": "motor"}, dict(RIVAL)]},
}


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_shares_are_raised_and_their_sum_is_kept(power: float) -> None:
    found = raised(EFFECT, power)
    (rival,) = found["alternatives"]
    assert found["probability"] + rival["probability"] == pytest.approx(0.97)
    assert found["probability"] / rival["probability"] == pytest.approx((0.6 / 0.37) ** power)
    assert [m["probability"] for m in found["one_of"]["members"]] == [found["probability"], rival["probability"]]
    assert EFFECT["probability"] == 0.6, "the verdict itself stays as it was"


def test_what_was_capped_or_stands_alone_stays() -> None:
    capped, alone = {**EFFECT, "probability": 0.4}, {**EFFECT, "alternatives": []}
    assert raised(capped, 2.0) == capped and raised(alone, 2.0) == alone


@pytest.mark.parametrize(("port", "better"), [("motor", True), ("arm", False)])
def test_a_power_pays_where_what_leads_is_right(port: str, better: bool) -> None:
    right = [[[port, "coulomb_friction"]]]
    key = {"effects": ["coulomb"], "accept": right, "near": [[]], "ports": [[port]], "sigma": 0.1, "strength": "weak"}
    verdict = {"effects": [EFFECT], "mismatch": True, "fit": [], "seconds": 1.0}
    case = score("one", verdict, key, said="dry friction")
    (names, answers), (more, all_of) = scored_at([case], 1.0), scored_at([case], 2.0)
    assert names == pytest.approx((0.6 - better) ** 2)
    assert (more < names) == (all_of < answers) == better


def test_folders_without_a_verdict_say_so(tmp_path: Path, capsys) -> None:
    main([tmp_path, tmp_path])
    assert "names nan" in capsys.readouterr().out
