"""Texts among the numbers of a column: marks of missing samples, and slips, each told with its own line."""

from __future__ import annotations

from pathlib import Path

import pytest

import greybox_torch as gt


@pytest.fixture
def drafted(tmp_path: Path):
    def draft(**cells: str) -> gt.CardResult:
        """The card of a file whose column y has other texts in some lines, as ``line_22="OVR"``."""
        rows = [f"{0.1 * k:.1f},{k % 7},{k % 5}.5" for k in range(60)]
        for place, text in cells.items():
            k = int(place.removeprefix("line_")) - 2
            rows[k] = ",".join([*rows[k].split(",")[:2], text])
        (tmp_path / "run.csv").write_text("\n".join(["t,u,y", *rows]))
        return gt.card(tmp_path / "run.csv")

    return draft


def test_a_mark_is_on_the_card_with_its_line(drafted) -> None:
    """Seen: "no column fits", and only below that which line was not read."""
    card = drafted(line_22="OVR")
    assert 'missing = "OVR"' in card.text and '"OVR" in line 22 of run.csv is taken for a missing sample' in card.text
    assert not [told for told in card.open if "mended" in told]


def test_a_slip_beside_a_mark_is_told_and_the_mark_has_its_own_line(drafted) -> None:
    card = drafted(line_7="1.2.3", line_22="OVR")
    assert 'missing = "OVR"' in card.text and '"OVR" in line 22 of run.csv is taken for a missing sample' in card.text
    (told,) = (told for told in card.open if "mended" in told)
    assert "line 7" in told and '"1.2.3"' in told
