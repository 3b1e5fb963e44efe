from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.effect import Timeline
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.verdict import Left, Verdict
from greybox_torch.report.sections.effects import Effects


def test_a_named_effect(of_kind: Callable[[str], Verdict]) -> None:
    effects = Effects.of(replace(of_kind("found"), left=Left(0.03, 1.2, "3 % of the mismatch remains in free runs.")))
    assert effects is not None
    (card,) = effects.cards
    assert (card.title, card.port, card.explained, card.unknown) == ("Backlash", "gear_spring", "97 %", False)
    assert (card.size, card.equation) == ("90 %", "the spring at gear_spring sees 0")
    (row,) = card.parameters
    assert (row.symbol, row.value, row.unit) == ("half_gap", "0.03100 ± 0.00040", "rad")
    assert [(s.mechanism, round(s.probability, 3)) for s in card.shares] == [
        ("backlash", 0.94),
        ("nonlinear stiffness", 0.04),
        ("anything else", 0.02),
    ]
    assert card.profiles is not None
    (((panel,),),) = (chart.columns for chart in card.curves)
    assert (panel.x_label, panel.y_label) == ("gear twist [rad]", "effect [N·m]")
    assert [mark.kind for mark in panel.marks] == ["area", "line"]


def test_what_its_parameters_are(of_kind: Callable[[str], Verdict]) -> None:
    """Seen: F_c, F_s, c, v_s and v_0 without a word of what they are."""
    verdict = of_kind("found")
    (effect,) = verdict.effects
    meant = {"half_gap": {"value": 0.04, "std": 1e-4, "unit": "rad", "description": "half the play"}}
    effects = Effects.of(replace(verdict, effects=(replace(effect, parameters=meant),)))
    assert effects is not None and [row.description for row in effects.cards[0].parameters] == ["half the play"]


def test_what_cannot_be_told_apart_stands_first(of_kind: Callable[[str], Verdict]) -> None:
    (effect,) = of_kind("found").effects
    members = (Alternative("gear_spring", "backlash", 0.9), Alternative("arm_spring", "backlash", 0.05))
    whole = OneOf("a coupling that is no linear spring at gear_spring or arm_spring", 0.95, members)
    effects = Effects.of(replace(of_kind("found"), effects=(replace(effect, probability=0.9, one_of=whole),)))
    assert effects is not None
    (card,) = effects.cards
    assert (card.statement[:10], card.title, card.probability) == ("A coupling", "Backlash", 0.95)
    assert [(s.mechanism, s.port, s.together, round(s.probability, 3)) for s in card.shares] == [
        ("backlash", "gear_spring", False, 0.9),
        ("backlash", "arm_spring", True, 0.05),
        ("nonlinear stiffness", "gear_spring", False, 0.04),
        ("anything else", "", False, 0.01),
    ]


def test_share_of_the_ceiling(of_kind: Callable[[str], Verdict]) -> None:
    (effect,) = of_kind("found").effects
    verdict = replace(of_kind("found"), effects=(effect, replace(effect, ceiling=0.88)))
    effects = Effects.of(verdict)
    assert effects is not None
    assert [card.ceiling for card in effects.cards] == ["", "88 %"]


def test_beside_others_the_size_alone_says_how_much(of_kind: Callable[[str], Verdict]) -> None:
    """The explained error is divided by the order of the search: seen, the largest effect "explains 14 %"."""
    (effect,) = of_kind("found").effects
    for beside in ({"effects": (effect, effect)}, {"refinements": (effect,)}):
        effects = Effects.of(replace(of_kind("found"), **beside))
        assert effects is not None
        assert {(card.size, card.explained) for card in effects.cards} == {("90 %", "")}


def test_where_along_the_experiments(of_kind: Callable[[str], Verdict]) -> None:
    """With many experiments, those in which the effect is strongest, on one vertical axis."""
    (effect,) = of_kind("found").effects
    edges = np.array([0.0, 1.0, 2.0, 3.0])
    lines = tuple(Timeline(f"Run {k}", edges, np.array([0.0, 0.01 * k, 0.02])) for k in range(6))
    effects = Effects.of(replace(of_kind("found"), effects=(effect, replace(effect, timelines=lines))))
    assert effects is not None
    bare, card = effects.cards
    assert bare.timelines is None and card.timelines is not None
    panels = [panel for (panel,) in card.timelines.columns]
    assert [panel.title for panel in panels] == [f"experiment Run {k}" for k in (2, 3, 4, 5)], "seen: c"
    assert len({panel.y for panel in panels}) == 1
    assert panels[-1].alt == (
        "Share of the explained error energy along Run 5: 7 % in all, most of it between 1.00 and 2.00 s."
    )
    assert "(it is weaker in 2 more)" in card.timelines.caption


def test_an_unknown_effect_shows_its_curve_not_its_weights(of_kind: Callable[[str], Verdict]) -> None:
    effects = Effects.of(of_kind("unknown"))
    assert effects is not None
    (card,) = effects.cards
    assert (card.title, card.parameters) == ("An unknown effect", ())
    assert len(card.curves) == 1


def test_nothing(of_kind: Callable[[str], Verdict]) -> None:
    assert Effects.of(of_kind("nothing")) is None


def test_remarks_begin_as_sentences_do_and_names_of_parameters_stay_as_they_are(
    of_kind: Callable[[str], Verdict],
) -> None:
    """Seen: "A: the standard deviation is larger" for the cosine's amplitude a, and a sentence that began "these recordings"."""
    (effect,) = of_kind("found").effects
    waves = {"a": {"value": 0.01, "std": 0.4, "unit": "rad"}, "b": {"value": 0.2, "std": 0.01, "unit": "rad"}}
    told = replace(effect, parameters=waves, of_line="a straight line does", like="these recordings show one direction")
    effects = Effects.of(replace(of_kind("found"), effects=(told,)))
    assert effects is not None
    remarks = effects.cards[0].remarks
    assert remarks.startswith("a: the standard deviation")
    assert remarks.endswith(". A straight line does. These recordings show one direction")
