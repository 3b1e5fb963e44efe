"""A question about a channel leads where the change that it is about would explain far more than what was found."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.slip_first import ports_of, with_question
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score

LEAD = "Is the sign of current turned? So changed"
ASKED = f"{LEAD}, a short refit reaches a mean fit of 99.2 % on the validation experiments"
CURVE = Effect("actuator", "unknown", 0.97, ("current",), "", {}, 0.5, (), None, size=0.85)


def verdict(fit: float, *effects: Effect, before: float = -798262.4) -> Verdict:
    scores = {name: (Score("C", "validation", "y", f, 1.0),) for name, f in (("refit", before), ("augmented", fit))}
    return Verdict("axis", "BeltAxis", 0, 1.0, 0.97, effects, {"start": scores["refit"], **scores}, (), {}, ())


def test_the_question_is_the_headline_and_the_effect_is_doubtful() -> None:
    """Seen: an unknown effect at the actuator (0.97) "from -798262.4 % to 71.6 %"; lines below, the sign that reaches 99.2 %."""
    told = with_question(verdict(71.6, CURVE), ASKED, 99.2, LEAD)
    assert told.sentence == (
        "Is the sign of current turned? So changed, a short refit leaves far less than what was found with the card as it is: an unknown "
        "effect at actuator (probability 0.50); with it the validation fit goes from below -1000 % to 71.6 %."
    )
    assert told.asked == (f"{ASKED}.",) and told.confidence == 0.5
    assert "a slip on the card" in told.effects[0].limited[0] and told.mismatch


@pytest.mark.parametrize(("fit", "first"), [(98.3, False), (98.5, False), (98.39, False), (98.0, True), (-20.0, True)])
def test_it_leads_only_where_far_less_would_be_left(fit: float, first: bool) -> None:
    told = with_question(verdict(fit, CURVE), ASKED, 99.1, LEAD)
    assert told.sentence.startswith("Is the sign") is first
    assert (told.effects[0].probability, told.confidence) == ((0.5, 0.5) if first else (0.97, 0.97))
    assert told.question == ASKED


@pytest.mark.parametrize(
    "lead",
    [
        LEAD,
        "Is the scale of speed right? With values 9.55 times smaller (rpm and rad/s differ by that)",
        "Is T2 recorded in K? Converted to degC",
        f"{LEAD}, and with Coulomb friction at rotor",
        "Is the scale of speed right? With values 9.55 times smaller, and with Coulomb friction at rotor",
        "Is the sign of current turned in axis? 2 alone? So changed",
    ],
)
def test_the_headline_says_what_was_changed(lead: str) -> None:
    """Seen: "Is the scale of speed right? So changed, …", of which a no explains the error; friction beside a sign was left out."""
    told = with_question(verdict(71.6, CURVE), f"{lead}, a short refit reaches 99.2 %", 99.2, lead)
    assert told.sentence.startswith(
        f"{lead}, a short refit leaves far less than what was found with the card as it is: "
    )


def test_a_class_that_is_capped_says_why() -> None:
    """Seen: a class of 0.97 told as 0.50 without a reason, as its first member had 0.35."""
    whole = OneOf("a gap at gear", 0.97, (Alternative("gear", "backlash", 0.35), Alternative("gear", "end_stop", 0.33)))
    effect = replace(CURVE, mechanism="backlash", one_of=whole, probability=0.35)
    (told,) = with_question(verdict(50.0, effect), ASKED, 99.1, LEAD).effects
    assert told.one_of is not None and (told.probability, told.one_of.probability) == (0.35, 0.5)
    assert "a slip on the card" in told.limited[0]


def test_a_class_is_no_surer_than_its_members_are_together() -> None:
    whole = OneOf("a gap at gear", 0.96, (Alternative("gear", "backlash", 0.9), Alternative("gear", "end_stop", 0.06)))
    told = with_question(
        verdict(50.0, replace(CURVE, mechanism="backlash", one_of=whole, probability=0.9)), ASKED, 99.1, LEAD
    )
    assert told.effects[0].one_of is not None and told.effects[0].one_of.probability == 0.5
    assert [m.probability for m in told.effects[0].one_of.members] == [0.5, 0.06]


def test_an_effect_that_is_doubtful_anyway_stays_as_it_is() -> None:
    told = with_question(verdict(50.0, replace(CURVE, probability=0.3)), ASKED, 99.1, LEAD)
    assert told.effects[0].probability == 0.3 and told.effects[0].limited == ()


def test_beside_nothing_found_it_is_asked_alone() -> None:
    told = with_question(replace(verdict(50.0), unexplained=20.0), ASKED, 99.1, LEAD)
    assert told.question == ASKED and not told.question_first and told.confidence == 0.97
    assert not told.sentence.startswith("Is the sign")


DRY = replace(CURVE, port="load", mechanism="coulomb_friction")
BIAS = replace(CURVE, mechanism="input_bias")


def test_a_slip_that_does_nearly_all_by_itself_leads_before_an_effect_at_its_channel() -> None:
    """Seen: a turned valve, told as an unknown effect at the actuator beside dry friction that is there (0.97 each, 98.3 %); the sign alone
    reached 94.5 % of -24 %."""
    told = with_question(verdict(98.3, CURVE, DRY, before=-24.0), ASKED, 94.5, LEAD, {"actuator"})
    assert told.sentence.startswith(
        f"{LEAD}, a short refit reaches 94.5 % without an unknown effect at actuator; with the card as it is: an unknown effect at "
        "actuator (probability 0.50), and Coulomb friction at load (probability 0.97)"
    )
    assert told.confidence == 0.5
    assert "nearly all by itself" in told.effects[0].limited[0] and not told.effects[1].limited


@pytest.mark.parametrize(
    ("effect", "reaches", "ports"),
    [
        (CURVE, 87.0, {"actuator"}),  # leaves more than a tenth
        (CURVE, 94.5, {"actuator.other"}),
        (BIAS, 94.5, {"actuator"}),  # nothing that a slip looks like
        (DRY, 94.5, {"actuator", "sensor"}),
    ],
)
def test_elsewhere_the_findings_lead(effect: Effect, reaches: float, ports: set[str]) -> None:
    told = with_question(verdict(98.3, effect, before=-24.0), ASKED, reaches, LEAD, ports)
    assert not told.question_first and told.effects == (effect,) and told.question == ASKED


@pytest.mark.parametrize(
    ("fit", "reaches", "before", "first"),
    [(79.5, 80.2, -60.0, True), (79.5, 79.4, -60.0, False), (93.0, 94.0, 10.0, False), (79.5, 80.2, -200.0, False)],
)
def test_it_leads_where_it_explains_as_much_as_findings_that_leave_much(
    fit: float, reaches: float, before: float, first: bool
) -> None:
    """Seen: a temperature in K, read as degC: an offset of -96497 W (0.97, 79.5 %), and below it a question that reaches 80.2 %."""
    told = with_question(verdict(fit, BIAS, before=before), ASKED, reaches, LEAD)
    assert bool(told.question_first) is first
    assert (told.effects[0].probability, told.confidence) == ((0.5, 0.5) if first else (0.97, 0.97))
    if first:
        assert told.sentence.startswith(
            f"{LEAD}, a short refit leaves no more than what was found with the card as it is: "
        )
        assert "would explain as much" in told.effects[0].limited[0]


def test_the_ports_of_channels_are_their_actuators_and_sensors(motor) -> None:
    assert ports_of(motor, {"voltage", "speed"}) == {"actuator", "sensor"}
    assert ports_of(motor, {"speed", "other"}) == {"sensor"}
