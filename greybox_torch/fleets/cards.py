"""The cards of a fleet: which there are, and what each data set is called."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from glob import glob, has_magic
from pathlib import Path

from greybox_torch.data.card import USUAL
from greybox_torch.errors import UserError
from greybox_torch.files import absolute


def find_cards(places: Iterable[str | os.PathLike[str]], *, beside: Path) -> dict[str, Path]:
    """The cards by the names of their data sets, sorted by name.

    A folder stands for every `dataset.toml` below it, a pattern (``line*/**/card_*.toml``) for the files that match, a file for itself. A
    data set is named by its folder, as seen from the place that was given; a card with another name than `dataset.toml` adds its own.

    Args:
        beside: a folder that is passed over: that of the results.

    Raises:
        UserError: a place does not exist, nothing was found, or two cards would have one name.
    """
    found: dict[str, Path] = {}
    for place in places:
        for root, card in _cards_at(os.fspath(place), absolute(beside)):
            name = _name(root, card)
            if found.setdefault(name, card) != card:
                raise UserError(
                    f"{found[name]} and {card} would both be called {name!r}; expected places below one folder"
                )
    if not found:
        shown = ", ".join(os.fspath(place) for place in places) or "nothing"
        raise UserError(f"{shown}: no data card found; expected a folder with {USUAL} somewhere below it, or a pattern")
    return dict(sorted(found.items()))


def _cards_at(place: str, beside: Path) -> Iterator[tuple[Path, Path]]:
    """Cards from the root of the file system on, each with the folder that its name is relative to."""
    path = Path(place)
    if path.is_dir():
        root = absolute(path)
        yield from ((root, card) for card in _below(root, beside))
    elif path.is_file():
        card = absolute(path)
        yield card.parent, card
    elif has_magic(place):
        root = absolute(_folder_before(path))
        for match in sorted(absolute(Path(match)) for match in glob(place, recursive=True)):  # noqa: PTH207 - may begin at the root
            card = match / USUAL if match.is_dir() else match
            if card.is_file() and beside not in card.parents:
                yield root, card
    else:
        raise UserError(f"{place}: no such folder or file; expected a folder of data sets, a pattern, or a card")


def _below(root: Path, beside: Path) -> Iterator[Path]:
    for folder, inner, files in os.walk(root):
        inner[:] = sorted(name for name in inner if not name.startswith(".") and Path(folder, name) != beside)
        if USUAL in files:
            yield Path(folder, USUAL)


def _folder_before(pattern: Path) -> Path:
    """The folder that a pattern begins in."""
    first = next(k for k, part in enumerate(pattern.parts) if has_magic(part))
    return Path(*pattern.parts[:first])


def _name(root: Path, card: Path) -> str:
    """Such as "line1/robot7": also the folder of its results below that of the fleet's."""
    folder = card.parent.relative_to(root).as_posix()
    own = () if card.name == USUAL else (card.stem,)
    parts = [*(() if folder == "." else (folder,)), *own]
    return "/".join(parts) or root.name or "recordings"
