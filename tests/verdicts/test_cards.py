"""Cases are found in folders, as cards and in lists, each with a name of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from experiments.verdicts.cards import chosen_cards, find_cards
from greybox_torch.errors import UserError

CARD = '[channels]\nu = { column = "u", unit = "V" }\n[[experiment]]\nname = "e"\nfile = "e.csv"\nrole = "estimation"\n'


@pytest.fixture
def cases(tmp_path: Path) -> Path:
    for place in (
        "a/dataset.toml",
        "a/complete.toml",
        "deep/b/dataset.toml",
        "cards/motor.toml",
        ".c.attempt/dataset.toml",
    ):
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).write_text(CARD)
    (tmp_path / "cards" / "settings.toml").write_text("[search]\nrounds = 3\n")
    (tmp_path / "a" / "key.json").write_text("never read")
    return tmp_path


def test_every_card_below_a_folder_has_a_name(cases: Path) -> None:
    found = find_cards([cases])
    assert {name: str(card.relative_to(cases)) for name, card in found.items()} == {
        "a_complete": "a/complete.toml",
        "a": "a/dataset.toml",
        "motor": "cards/motor.toml",
        "b": "deep/b/dataset.toml",
    }


def test_cards_and_lists_are_taken_too(cases: Path) -> None:
    (cases / "list.txt").write_text("# these\nfirst a/dataset.toml\n\nsecond deep/b/dataset.toml\n")
    found = find_cards([cases / "cards" / "motor.toml", cases / "list.txt"])
    assert list(found) == ["motor", "first", "second"]
    assert list(chosen_cards(found, "second, motor")) == ["second", "motor"]
    assert chosen_cards(found, "") == found


def test_a_card_that_cannot_be_read_is_left_to_the_tool(cases: Path) -> None:
    (cases / "a" / "dataset.toml").write_text("[channels\n")
    assert "a" in find_cards([cases / "a"])


@pytest.mark.parametrize(
    ("place", "said"),
    [("nowhere", "not there"), ("a/key.json", "line 1 is"), ("empty", "no data set's card")],
)
def test_places_without_cases_are_said(cases: Path, place: str, said: str) -> None:
    (cases / "empty").mkdir()
    with pytest.raises(UserError, match=said):
        find_cards([cases / place])


def test_two_cases_of_one_name_are_said(cases: Path) -> None:
    (cases / "other" / "b").mkdir(parents=True)
    (cases / "other" / "b" / "dataset.toml").write_text(CARD)
    with pytest.raises(UserError, match="its case is called b, and so is that of"):
        find_cards([cases])
    assert list(find_cards([cases / "a", cases / "a" / "dataset.toml"])) == ["a_complete", "a"]


def test_an_unknown_name_is_said(cases: Path) -> None:
    with pytest.raises(UserError, match=r'no case is called moter \(did you mean "motor"\?\)'):
        chosen_cards(find_cards([cases]), "moter")
