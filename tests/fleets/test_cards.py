"""Which cards there are below a place, and what their data sets are called."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.errors import UserError
from greybox_torch.fleets.cards import find_cards


@pytest.fixture
def plant(tmp_path: Path) -> Path:
    for place in ("line1/a/dataset.toml", "line1/b/dataset.toml", "line2/a/dataset.toml", "line2/a/card_hot.toml"):
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).write_text("")
    return tmp_path


def test_folder(plant: Path) -> None:
    (plant / ".hidden").mkdir()
    (plant / ".hidden" / "dataset.toml").write_text("")
    assert list(find_cards([plant], beside=plant / "out")) == ["line1/a", "line1/b", "line2/a"]
    assert find_cards([plant / "line1"], beside=plant)["a"] == (plant / "line1/a/dataset.toml").resolve()


def test_results_are_passed_over(plant: Path) -> None:
    assert list(find_cards([plant], beside=plant / "line1")) == ["line2/a"]


def test_patterns_files_and_several(plant: Path) -> None:
    assert list(find_cards([f"{plant}/*/*/card_*.toml"], beside=plant / "out")) == ["line2/a/card_hot"]
    assert list(find_cards([f"{plant}/line*/a"], beside=plant / "out")) == ["line1/a", "line2/a"]
    assert list(find_cards([plant / "line2/a/dataset.toml"], beside=plant / "out")) == ["a"]
    assert list(find_cards([plant / "line1", f"{plant}/*/a/card_hot.toml"], beside=plant / "out")) == [
        "a",
        "b",
        "line2/a/card_hot",
    ]


def test_a_card_at_the_root_is_called_after_its_folder(plant: Path) -> None:
    assert list(find_cards([plant / "line1/a"], beside=plant / "out")) == ["a"]


def test_one_name_for_two(plant: Path) -> None:
    with pytest.raises(UserError, match="would both be called 'a'"):
        find_cards([plant / "line1", plant / "line2"], beside=plant / "out")
    assert list(find_cards([plant, plant], beside=plant / "out")) == ["line1/a", "line1/b", "line2/a"]


def test_nothing_there(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no data card found"):
        find_cards([tmp_path], beside=tmp_path / "out")
    with pytest.raises(UserError, match="no data card found"):
        find_cards([f"{tmp_path}/*.toml"], beside=tmp_path / "out")
    with pytest.raises(UserError, match="no such folder or file"):
        find_cards([tmp_path / "nowhere"], beside=tmp_path / "out")
