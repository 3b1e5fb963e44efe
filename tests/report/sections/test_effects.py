from __future__ import annotations

from collections.abc import Callable

from greybox_torch.diagnose.verdict import Verdict
from greybox_torch.report.sections.effects import Effects


def test_a_named_effect(of_kind: Callable[[str], Verdict]) -> None:
    effects = Effects.of(of_kind("found"))
    assert effects is not None
    (card,) = effects.cards
    assert (card.title, card.port, card.explained, card.unknown) == ("Backlash", "gear_spring", "97 %", False)
    (row,) = card.parameters
    assert (row.symbol, row.value, row.unit) == ("half gap", "0.03100 ± 0.00040", "rad")
    assert [(s.mechanism, round(s.probability, 3)) for s in card.shares] == [
        ("backlash", 0.94),
        ("nonlinear stiffness", 0.04),
        ("anything else", 0.02),
    ]
    assert card.curve is not None and card.profiles is not None
    ((panel,),) = card.curve.columns
    assert (panel.x_label, panel.y_label) == ("gear twist [rad]", "effect [N·m]")
    assert [mark.kind for mark in panel.marks] == ["area", "line"]


def test_an_unknown_effect_shows_its_curve_not_its_weights(of_kind: Callable[[str], Verdict]) -> None:
    effects = Effects.of(of_kind("unknown"))
    assert effects is not None
    (card,) = effects.cards
    assert (card.title, card.parameters) == ("An unknown effect", ())
    assert card.curve is not None


def test_nothing(of_kind: Callable[[str], Verdict]) -> None:
    assert Effects.of(of_kind("nothing")) is None
