"""The response of an unknown effect that remembers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.sections.effects import Effects
from greybox_torch.report.sections.memory import memory_chart


def test_card_and_sentence_say_how_long_it_remembers(of_kind: Callable[[str], Verdict]) -> None:
    verdict = of_kind("memory")
    effects = Effects.of(verdict)
    assert effects is not None
    (card,) = effects.cards
    assert card.title == "An unknown effect with memory"
    assert [(str(row.symbol), row.value) for row in card.parameters] == [("<i>T</i>", "0.0800 ± 0.0020")]
    assert "an unknown effect at motor, with a memory of about 0.08 s (probability 0.88)" in verdict.sentence
    (response,) = card.curves  # a straight line over the signal says no more than its first value
    assert [panel.y_label for (panel,) in response.columns] == ["amplitude [N·m/(rad/s)]", "phase [°]"]
    assert "from motor speed to the force that it adds at motor" in response.caption


def test_amplitude_and_phase_have_their_bands(of_kind: Callable[[str], Verdict]) -> None:
    (effect,) = of_kind("memory").effects
    assert effect.memory is not None
    chart = memory_chart(effect, effect.memory)
    amplitude, phase = (panel for (panel,) in chart.columns)
    assert [[mark.kind for mark in panel.marks] for panel in (amplitude, phase)] == [["area", "line"]] * 2
    assert (
        amplitude.alt
        == "Amplitude of the effect's response over frequency: from 0.280 N·m/(rad/s) to 0.0342 N·m/(rad/s)."
    )
    assert phase.alt.endswith("from 178 to 60 degrees.")


def test_behind_a_curve_both_are_shown(of_kind: Callable[[str], Verdict]) -> None:
    verdict = of_kind("memory")
    (effect,) = verdict.effects
    assert effect.memory is not None
    heights = {"w_0": {"value": 0.1, "std": None, "unit": "N m"}}
    curved = replace(
        effect, parameters={**heights, **effect.parameters}, memory=replace(effect.memory, curved=True, unit="")
    )
    effects = Effects.of(replace(verdict, effects=(curved,)))
    assert effects is not None
    (row,) = effects.cards[0].parameters
    assert str(row.symbol) == "<i>T</i>", "of a curve no heights"
    law, response = effects.cards[0].curves
    assert law.caption.endswith("over gear twist, once all has settled.")
    assert "from the curve over motor speed" in response.caption


def test_the_verdict_has_response_and_curve(of_kind: Callable[[str], Verdict]) -> None:
    (entry,) = of_kind("memory").as_json()["effects"]
    memory = entry["memory"]
    assert entry["mechanism"] == "unknown" and "curve" in entry
    assert (memory["seconds"], memory["std"], memory["states"], memory["behind_curve"]) == (0.08, 0.002, 1, False)
    assert set(memory["response"]) == {"frequency", "gain", "gain_std", "phase", "phase_std"}
    assert {len(values) for values in memory["response"].values()} == {41}
