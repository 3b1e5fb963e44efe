"""Settings of a diagnosis: what they may be, where they come from, how they are told."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from greybox_torch.diagnosis.settings import (
    DiagnosisSettings,
    SearchBudget,
    changed_settings,
    setting_rows,
    settings_from_file,
    settings_from_mapping,
)
from greybox_torch.errors import UserError
from greybox_torch.estimate.levenberg_marquardt import Settings


def test_a_value_out_of_bounds_names_the_field_what_was_found_and_what_is_expected() -> None:
    with pytest.raises(UserError, match=r"DiagnosisSettings: least_gain: found 2; expected a number from 0 to 1"):
        DiagnosisSettings(least_gain=2)
    with pytest.raises(UserError, match="SearchBudget: finalists: found 0; expected an integer of at least 1"):
        SearchBudget(finalists=0)
    with pytest.raises(UserError, match="polish_iterations: iterations: found 0"):
        SearchBudget(polish_iterations=Settings(iterations=0))


@pytest.mark.parametrize("value", [True, "0.1", float("nan"), None])
def test_what_is_not_a_number_is_refused(value) -> None:
    with pytest.raises(UserError, match="least_gain: found"):
        DiagnosisSettings(least_gain=value)


def test_fields_of_both_come_from_one_mapping() -> None:
    given = {"least_gain": 0.02, "window_factors": [1, 4], "polish_iterations": {"iterations": 7}}
    settings, budget = settings_from_mapping(given, "card")
    assert settings == DiagnosisSettings(least_gain=0.02)
    assert budget.window_factors == (1, 4)
    assert budget.polish_iterations == dataclasses.replace(SearchBudget().polish_iterations, iterations=7)
    assert settings_from_mapping({}, "card") == (DiagnosisSettings(), SearchBudget())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"least_gian": 0.1}, r'^card: "least_gian" is not a setting \(did you mean "least_gain"\?\); expected'),
        ({"least_gain": -1.0}, r"^card: least_gain: found -1.0; expected a number from 0 to 1"),
        ({"finalists": 2.5}, r"^card: finalists: found 2.5; expected an integer"),
        ({"window_factors": []}, r"^card: window_factors: found \(\); expected a list of integers"),
        (
            {"polish_iterations": {"iteration": 3}},
            r'polish_iterations: "iteration" is unknown \(did you mean "iterations"',
        ),
        ({"polish_iterations": 3}, r"polish_iterations: found 3; expected the limits of an iteration"),
    ],
)
def test_a_mistake_in_a_mapping_is_told_with_its_place(given, message) -> None:
    with pytest.raises(UserError, match=message):
        settings_from_mapping(given, "card")


def test_names_of_settings_and_budget_differ() -> None:
    names = [{f.name for f in dataclasses.fields(kind)} for kind in (DiagnosisSettings, SearchBudget)]
    assert not names[0] & names[1]


def test_what_differs_from_the_default_comes_first() -> None:
    rows = setting_rows(DiagnosisSettings(runaway=500.0), SearchBudget(knots=20))
    assert [(r.name, r.value, r.default, r.changed) for r in rows[:2]] == [
        ("runaway", "500", "1000", True),
        ("knots", "20", "14", True),
    ]
    assert not any(r.changed for r in rows[2:])
    fields = [*dataclasses.fields(DiagnosisSettings), *dataclasses.fields(SearchBudget)]
    assert sorted(r.name for r in rows) == sorted(f.name for f in fields)
    assert all(r.meaning.endswith((".", ".)")) and r.chosen_by for r in rows)


def test_a_file_of_settings(tmp_path: Path) -> None:
    flat, inside, wrong = (tmp_path / name for name in ("flat.toml", "inside.toml", "wrong.toml"))
    flat.write_text("knots = 20\n")
    inside.write_text("[diagnosis]\nknots = 20\n")
    wrong.write_text("knots = \n")
    assert settings_from_file(flat) == settings_from_file(inside) == {"knots": 20}
    with pytest.raises(UserError, match=r"wrong\.toml: not valid TOML"):
        settings_from_file(wrong)
    with pytest.raises(UserError, match=r"absent\.toml: no such file"):
        settings_from_file(tmp_path / "absent.toml")


def test_what_differs_makes_the_same_settings_again() -> None:
    iterations = dataclasses.replace(SearchBudget().polish_iterations, iterations=20)
    given = DiagnosisSettings(runaway=500.0), SearchBudget(window_factors=(1, 8), polish_iterations=iterations)
    told = json.loads(json.dumps(changed_settings(*given)))
    assert set(told) == {"runaway", "window_factors", "polish_iterations"}
    assert settings_from_mapping(told, "verdict.json") == given
    assert changed_settings(DiagnosisSettings(), SearchBudget()) == {}
