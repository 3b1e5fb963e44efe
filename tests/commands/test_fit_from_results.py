"""`fit --checkpoint`: an estimation that goes on from earlier results."""

from __future__ import annotations

import json

import pytest

from greybox_torch.checkpoint import load_checkpoint
from tests.commands.free_running import Edit, Make, greybox, of, saved


def test_begins_with_the_values_of_the_checkpoint(motor_folder: Make) -> None:
    folder = motor_folder()
    good = saved(folder, "good", 0.0201)
    found, compared = of("fit", folder, "--checkpoint", good), of("compare", folder, good)
    of_good = next(m for m in compared["models"] if m["name"] == "good")["fit"]
    assert [row["start"]["fit"] for row in found["fit"]] == pytest.approx([row["fit"] for row in of_good], rel=1e-9)
    assert of("fit", folder)["parameters"]["J"]["value"] == pytest.approx(found["parameters"]["J"]["value"], rel=1e-4)


def test_goes_on_from_its_own_results(motor_folder: Make) -> None:
    folder = motor_folder()
    first = of("fit", folder)
    again = of("fit", folder, "--checkpoint", first["checkpoint"])
    assert again["parameters"]["J"]["value"] == pytest.approx(first["parameters"]["J"]["value"], rel=1e-6)
    assert again["statistics"]["iterations"] < first["statistics"]["iterations"]


def test_what_the_card_fixes_stays_at_the_value_of_the_results(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "J = { value = 0.03 }", "J = { value = 0.03, fixed = true }")
    inertia = of("fit", folder, "--checkpoint", saved(folder, "good", 0.021))["parameters"]["J"]
    assert (inertia["value"], inertia["fixed"]) == (0.021, True)


def test_effects_are_estimated_too(motor_folder: Make) -> None:
    folder = motor_folder(dead_zone=1.0)
    diagnosed = greybox("diagnose", folder, "--time-limit", "20")
    assert diagnosed.exit_code == 0
    effects = set(load_checkpoint(folder / "out" / "model").values)
    found = json.loads(greybox("fit", folder, "--checkpoint", str(folder / "out" / "model"), "--json").stdout)
    assert set(found["parameters"]) == effects and effects > {"J", "k", "b"}


def test_refuses_what_is_no_checkpoint(motor_folder: Make) -> None:
    result = greybox("fit", motor_folder(), "--checkpoint", "nowhere/model")
    assert result.exit_code == 2
    assert "checkpoint nowhere/model: no such file or folder" in result.stderr
