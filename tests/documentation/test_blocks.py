"""Python and cards in the pages are run and read as they stand."""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest

import greybox_torch as gt
from greybox_torch.data.card import Card
from greybox_torch.diagnosis.beliefs import beliefs_from_mapping
from greybox_torch.diagnosis.settings.mapping import settings_from_mapping
from greybox_torch.systems import RobotArm
from tests.documentation.pages import ROOT, blocks, pages_with

Make = Callable[..., Path]
SMALLEST = tomllib.loads(blocks("docs/howto/data.md", "toml")[0][1])
OWN_TESTS = {"docs/howto/extending.md", "docs/tutorial/first_diagnosis.md"}
"""Pages whose code is run by tests/extending and test_commands.py, as that of the recipes by test_recipes.py."""


@pytest.mark.parametrize(
    "page", [page for page in pages_with("python") if page not in OWN_TESTS and "/recipes/" not in page]
)
def test_python(page: str, motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks of a page one after the other, in a folder with the motor's card, the demo and the trained models."""
    folder = motor_folder()
    monkeypatch.chdir(folder)
    for name in ("greybox_torch", "checkpoints"):
        (folder / name).symlink_to(ROOT / name)
    monkeypatch.setattr(gt, "fleet", fleet_as_declared)
    names: dict[str, Any] = given(folder)
    for _, text in blocks(page, "python"):
        exec(compile(text, page, "exec"), names)


def given(folder: Path) -> dict[str, Any]:
    """What pages that begin in the middle speak of: signals of the motor and a table of them."""
    table = np.loadtxt(folder / "sweep.csv", delimiter=",", skiprows=1)
    u, w = table.T
    frame = pandas.DataFrame({"t": 0.01 * np.arange(len(u)), "voltage": u, "speed": w})
    return {"u": u, "w": w, "y": w, "frame": frame}


def fleet_as_declared(*arguments: Any, **options: Any) -> Any:
    """In the place of `gt.fleet`, which starts processes (tests/commands/test_fleet.py): takes what it takes, has what its result has."""
    from greybox_torch.api.fleet import fleet
    from greybox_torch.api.fleet_result import FleetResult

    inspect.signature(fleet).bind(*arguments, **options)
    return FleetResult(())


@pytest.mark.parametrize("page", pages_with("toml"))
def test_cards(page: str) -> None:
    """Every card, and every part of one beside the smallest, can be read; settings and limits are known."""
    for _, text in blocks(page, "toml"):
        card = SMALLEST | tomllib.loads(text)
        if "time" in card and card["time"] != SMALLEST.get("time"):
            del card["sample_time"]
        read = Card.model_validate(card)
        settings_from_mapping(read.diagnosis, page)
        if read.beliefs:
            beliefs_from_mapping(read.beliefs, RobotArm(), page)
