"""How a page came about: the settings among it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget, setting_rows
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page
from greybox_torch.report.sections.making import Making


def test_settings_that_differ_stand_first_and_are_marked(of_kind: Callable[[str], Verdict], about: About) -> None:
    verdict = replace(
        of_kind("found"), settings=DiagnosisSettings(least_significance=4.0), budget=SearchBudget(knots=20)
    )
    made = Making.of(verdict, about)
    assert [(row.name, row.value) for row in made.changed] == [("least_significance", "4"), ("knots", "20")]
    assert made.settings == setting_rows(verdict.settings, verdict.budget)
    page = render_page(verdict, about)
    assert "2 of " in page and "knots is 20 instead of 14" in page
    table = page[page.index('<table class="settings">') :]
    assert table.count('class="chosen"') == 2
    assert table.index("least_significance") < table.index("knots") < table.index("noise_differences")


def test_beliefs_are_told(of_kind: Callable[[str], Verdict], about: About) -> None:
    plain = of_kind("found")
    assert "Known beforehand" not in render_page(plain, about) and "beliefs" not in plain.as_json()
    given = {"gear_spring/backlash": 0.0, "*/coulomb_friction": 0.9, "motor/*": 0.1}
    verdict = replace(plain, beliefs=Beliefs(given))
    page = " ".join(re.sub("<[^>]+>", "", render_page(verdict, about)).split())
    assert "backlash at gear_spring: excluded" in page
    assert "Coulomb friction at any port: probability 0.90 where the recordings leave it open" in page
    assert "any mechanism at motor: probability 0.10" in page
    assert verdict.as_json()["beliefs"] == given


def test_settings_at_their_default_are_told_to_be(of_kind: Callable[[str], Verdict], about: About) -> None:
    page = render_page(of_kind("nothing"), about)
    assert f"All {len(setting_rows(DiagnosisSettings(), SearchBudget()))} are at their default." in page
    assert "<small>changed</small>" not in page
    assert all(row.name in page for row in setting_rows(DiagnosisSettings(), SearchBudget()))
