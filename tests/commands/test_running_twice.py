"""Results in a folder that holds earlier ones: what is no more goes, and whose model is replaced is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from greybox_torch.api.hypotheses import kept_hypotheses
from greybox_torch.cli import app
from greybox_torch.files import remove_all, write_all
from tests.commands.diagnosing import FILES, Make, diagnose, written
from tests.commands.fitting import fit

EARLIER = {"hypotheses/7-rotor-gravity.json", "hypotheses/7-rotor-gravity.safetensors", "report.pdf"}


def train(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["train", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])


def laid(folder: Path, *names: str) -> None:
    write_all({folder / name: "of before" for name in names})


def test_what_an_earlier_diagnosis_left_goes(motor_folder: Make) -> None:
    """Seen: ten hypotheses beside a hypotheses.json that named two of them, and a report.pdf of another verdict."""
    folder = motor_folder()
    laid(folder / "out", *EARLIER, "hypotheses/notes.txt", "mine.pdf")
    result = diagnose(folder, "--time-limit", "1")
    assert result.exit_code == 0, result.stderr
    there = {str(p.relative_to(folder / "out")) for p in (folder / "out").rglob("*") if p.is_file()}
    assert not EARLIER & there and there >= {*FILES, "hypotheses/notes.txt", "mine.pdf"}
    assert "warning" not in result.stderr


def test_a_folder_that_is_empty_then_goes_too(tmp_path: Path) -> None:
    laid(tmp_path, *EARLIER)
    assert len(kept_hypotheses(tmp_path)) == 2
    remove_all([*kept_hypotheses(tmp_path), tmp_path / "hypotheses" / "not there"])
    assert [p.name for p in tmp_path.iterdir()] == ["report.pdf"]


@pytest.mark.parametrize(
    ("before", "told"),
    [
        (["verdict.json", "model.json"], "holds results of greybox diagnose (verdict.json), whose model (model.json, "),
        (
            ["verdict.json", "train.json", "model.json"],
            "greybox diagnose (verdict.json) and greybox train (train.json)",
        ),
        (["fit.json", "model.json"], ""),
        (["verdict.json"], ""),
    ],
)
def test_whose_model_is_replaced_is_told(motor_folder: Make, before: list[str], told: str) -> None:
    """Seen: `diagnose`, then `fit`, both to results/<folder>; `export` then wrote the model without its effects, and nothing said so."""
    folder = motor_folder()
    laid(folder / "out", *before)
    result = fit(folder)
    assert result.exit_code == 0, result.stderr
    assert ("warning" in result.stderr) == bool(told) and told in result.stderr
    assert {"fit.json", *before} <= set(written(folder))


@pytest.mark.parametrize(
    ("run", "table", "options"),
    [
        (diagnose, '[beliefs]\n"rotr/*" = 0.1\n', ()),
        (diagnose, "[diagnosis]\nmost_effect = 1\n", ()),
        (diagnose, "", ("--time-limit", "0")),
        (fit, "", ("--profile", "bb")),
        (train, "", ("--port", "rotr")),
    ],
)
def test_what_is_refused_replaces_nothing(
    motor_folder: Make, run: Callable[..., Result], table: str, options: tuple[str, ...]
) -> None:
    """Seen: "whose model this command replaces" before an error about a typo."""
    folder = motor_folder()
    laid(folder / "out", "verdict.json", "fit.json", "model.json")
    card = folder / "dataset.toml"
    card.write_text(f"{card.read_text()}\n{table}")
    result = run(folder, *options)
    assert result.exit_code == 2 and "error: " in result.stderr
    assert "warning" not in result.stderr


def test_figures_of_other_profiles_go(motor_folder: Make) -> None:
    folder = motor_folder()
    laid(folder / "out", "profile_b.png", "profile_of_mine.png")
    assert fit(folder).exit_code == 0
    assert "profile_b.png" not in written(folder) and "profile_of_mine.png" in written(folder)
