"""Which cases there are: every data set's card below some folders, each with a name of its own."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path

from greybox_torch import UserError
from greybox_torch.errors import did_you_mean


def find_cards(places: Sequence[Path]) -> dict[str, Path]:
    """Cards by the name of their case, in the order given and sorted within a folder.

    Args:
        places: folders (every card in or below them), cards, and lists: text files with a line `NAME CARD` a case, where a card is
            relative to the list.

    Raises:
        UserError: a place is not there or holds no card, a line of a list is not understood, two cases have one name.
    """
    found: dict[str, Path] = {}
    for place in places:
        for name, card in _cases_of(place):
            if name in found and found[name].resolve() != card.resolve():
                raise UserError(
                    f"{card}: its case is called {name}, and so is that of {found[name]}; expected different names, "
                    "which a list of lines NAME CARD gives"
                )
            found[name] = card
    return found


def chosen_cards(cards: dict[str, Path], names: str) -> dict[str, Path]:
    """Those of a comma-separated list of names, all where it is empty. Raises UserError where a name is unknown."""
    wanted = names_of(names)
    for name in wanted:
        if name not in cards:
            raise UserError(f"--only: no case is called {name}{did_you_mean(name, cards)}")
    return {name: cards[name] for name in wanted} if wanted else cards


def names_of(listed: str) -> list[str]:
    """The names of a comma-separated list."""
    return [name.strip() for name in listed.split(",") if name.strip()]


def case_name(card: Path) -> str:
    """By the folder for `dataset.toml`, by folder and file for another card that lies beside one, by the file for any other card."""
    folder = card.resolve().parent
    if card.name == "dataset.toml":
        return folder.name
    return f"{folder.name}_{card.stem}" if (folder / "dataset.toml").is_file() else card.stem


def _cases_of(place: Path) -> Iterable[tuple[str, Path]]:
    if place.is_dir():
        cards = [file for file in sorted(place.rglob("*.toml")) if not _hidden(file, place) and _is_card(file)]
        if not cards:
            raise UserError(
                f"{place}: no data set's card (a .toml file with experiments and channels) is in or below it"
            )
        return [(case_name(card), card) for card in cards]
    if not place.is_file():
        raise UserError(f"{place}: not there; expected a folder of cases, a card, or a list of lines NAME CARD")
    return [(case_name(place), place)] if place.suffix == ".toml" else _listed(place)


def _listed(file: Path) -> list[tuple[str, Path]]:
    cases = []
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{file}: {error}; expected a list of lines NAME CARD") from None
    for number, line in enumerate(lines, start=1):
        words = line.split(maxsplit=1)
        if not words or line.lstrip().startswith("#"):
            continue
        card = file.parent / words[-1].strip()
        if len(words) != 2 or not card.is_file():
            raise UserError(
                f"{file}: line {number} is {line.strip()!r}; expected the name of a case and a card that is there"
            )
        cases.append((words[0], card))
    return cases


def _hidden(file: Path, below: Path) -> bool:
    return any(part.startswith(".") for part in file.relative_to(below).parts)


def _is_card(file: Path) -> bool:
    """Whether a .toml file is a data set's card. One that cannot be read counts where its name says so: the tool will say why."""
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return file.name == "dataset.toml"
    return "experiment" in content and "channels" in content
