"""What a verdict says beside its sentence and its tables."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.api.verdict_summary import REFIT, SIZE, effect_table, moved_table, notes, which_refit
from greybox_torch.diagnosis.begun import begun
from greybox_torch.diagnosis.not_tried import MOST_NAMED, NotTried
from greybox_torch.diagnosis.one_of import DECIDED_BY, Alternative, OneOf
from greybox_torch.diagnosis.own_parameters import Estimate
from greybox_torch.diagnosis.verdict import STOPPED, Left
from greybox_torch.estimate.initial import BEGINNINGS
from greybox_torch.estimate.notes import told_at_bound, told_law_at_bound
from greybox_torch.report.sections.effects import Effects
from greybox_torch.report.sections.headline import Headline
from tests.diagnosis.test_verdict import BACKLASH, verdict

CUT = NotTried(("searching: screen, refit, select",), (("rotor", "quadratic_drag"), ("rotor", "constant_bias")))


@pytest.mark.parametrize("effects", [(), (BACKLASH,)])
def test_a_search_that_was_stopped_says_so_and_what_was_not_tried(effects) -> None:
    """Seen: a diagnosis stopped after its first finding; the console said nothing of it."""
    told = notes(replace(verdict(*effects, complete=False), evidence=("some tests", STOPPED), not_tried=CUT))
    assert told.count(STOPPED) == 1
    assert told[-2:] == [
        "Not finished: searching.",
        "Not tried any more: quadratic drag at rotor, constant bias at rotor.",
    ]


@pytest.mark.parametrize("effects", [(), (BACKLASH,)])
def test_a_whole_search_says_nothing_of_it(effects) -> None:
    assert not any("stopped" in line or "Not tried" in line for line in notes(verdict(*effects)))


def test_of_several_outputs_it_is_said_which_refit_the_table_has() -> None:
    """Seen: tables of `fit`, `diagnose` and `train` that all head "refit", with different numbers."""
    one = verdict()
    two = {name: (*own, replace(own[0], output="another")) for name, own in one.scores.items()}
    assert (
        which_refit(replace(one, scores=two)) == [REFIT] and which_refit(replace(one, scores=two, complete=False)) == []
    )
    assert which_refit(replace(one, scores={name: own[:1] for name, own in one.scores.items()})) == []


def test_parameters_that_are_not_determined_are_told() -> None:
    """Seen: a nonlinear stiffness with F_0 = 0.39 ± 4.1 in the table, without a word."""
    entry = {"unit": "N", "description": ""}
    vague, infinite = {"value": 0.39, "std": 4.1, **entry}, {"value": -2.0, "std": float("inf"), **entry}
    effect = replace(BACKLASH, parameters={"half_gap": {"value": 0.03, "std": 0.001, **entry}, "F_0": vague})
    told = [line for line in notes(verdict(effect)) if "standard deviation" in line]
    assert told == [
        "backlash at gear_spring: F_0: the standard deviation is larger than the value; it may be zero, or these recordings do not "
        "determine it beside the other parameters"
    ]
    both = replace(BACKLASH, parameters={"F_0": vague, "d_0": infinite})
    assert both.undetermined.startswith("F_0, d_0: ") and "they may be zero" in both.undetermined
    assert replace(BACKLASH, parameters={"F_0": {"value": 1.0, "std": 0.9, **entry}}).undetermined == ""
    fixed = {"F_0": {"value": 1.0, "std": None, **entry}}
    assert replace(BACKLASH, parameters={"half_gap": {"value": 0.03, "std": 0.001, **entry}} | fixed).undetermined == ""
    # seen: a warm-up and gravity of searches that were stopped, without deviations in the table and without a word
    assert replace(BACKLASH, parameters=fixed).undetermined.startswith(
        "no standard deviations are known: whole records were not fitted"
    )


def test_a_parameter_of_a_law_at_its_bound_is_told_as_fit_tells_it() -> None:
    """Seen: a sharpness of 1 ± 0.088 with the bounds [0, 1] in the table, without a word."""
    entry = {"value": 1.0, "std": 0.088, "unit": "", "description": ""}
    effect = replace(BACKLASH, parameters={"sharpness": entry}, at_bounds=("sharpness",))
    (told,) = [line for line in notes(verdict(effect)) if "bound" in line]
    assert told == f"backlash at gear_spring: {told_law_at_bound('sharpness = 1')}"
    shown = Effects.of(verdict(effect))
    assert shown is not None and shown.cards[0].bounded == told_law_at_bound("sharpness = 1")
    assert not [line for line in notes(verdict(replace(effect, mechanism="unknown"))) if "At a bound" in line]
    assert effect.remarks == ("at a bound: sharpness = 1",), "seen: both sentences once more in the evidence"
    zero = replace(effect, parameters={"sharpness": {**entry, "value": 0.0}})
    assert zero.undetermined == "" and replace(zero, at_bounds=()).undetermined, "seen: two remarks that say the same"


def test_waves_are_told_by_their_amplitude() -> None:
    """Seen: a and b of a transmission error, and nowhere the 0.42 mrad that a data sheet has."""
    entry = {"std": 1e-4, "unit": "rad"}
    waves = {"a": {"value": 3e-4, **entry}, "b": {"value": 4e-4, **entry}}
    effect = replace(BACKLASH, parameters=waves, amplitudes={"b": (5e-4, 2e-5)})
    assert effect_table(verdict(effect))[1][2][4:] == ["(amplitude)", 5e-4, 2e-5, "rad"]
    shown = Effects.of(verdict(effect))
    assert shown is not None and [str(row.symbol) for row in shown.cards[0].parameters][2] == "amplitude"


def test_an_experiment_that_no_longer_judges_is_told_first() -> None:
    """Seen: a validation experiment among those estimated from in the table, and not a word of it but in the evidence."""
    told = "Run 3 no longer counts as validation: it was taken to choose with as well (the evidence says why)."
    found = replace(verdict(BACKLASH), no_longer_validation=(told,))
    assert notes(found)[:2] == [told, SIZE]
    assert told not in notes(replace(verdict(), no_longer_validation=(told,)))  # the evidence stands there


def test_validation_experiments_that_are_short_are_told_of_whatever_is_found() -> None:
    """Seen: 80 s of a machine with minutes; a probability of 0.5, and no word of why."""
    told = "The validation experiment lasts 80 s."
    assert notes(replace(verdict(BACKLASH), short_validation=(told,)))[:2] == [told, SIZE]
    short = replace(verdict(), short_validation=(told,))
    assert notes(short)[0] == told and short.as_json()["short_validation"] == [told]
    assert Headline.of(short).beside == (told,)


def test_the_size_of_an_effect_is_told_and_its_equation() -> None:
    """Seen: friction without which all of the mismatch is back "explains 14 %", a ripple of size 0.29 "explains 86 %"."""
    effect = replace(BACKLASH, probability=0.9676, size=0.28778, explained=0.8587, equation="port.gear_spring += -F_c")
    heads, rows = effect_table(verdict(effect))
    assert heads[3] == "size [%]" and rows[0][2:4] == [0.97, 28.8]
    assert effect_table(verdict(replace(effect, size=float("nan"))))[1][0][3] == ""
    told = notes(verdict(effect))
    assert told[0] == SIZE and told[1] == "backlash at gear_spring: port.gear_spring += -F_c"
    assert SIZE not in notes(verdict())


def test_sizes_that_are_small_as_others_make_up_for_each_are_explained() -> None:
    """Seen: a delay of size 16 % as the only finding, with which the fit went from 75 to 97 %: a lag beside it was a refinement."""
    small = replace(BACKLASH, mechanism="sensor_lag", size=0.02)
    both = replace(verdict(replace(BACKLASH, size=0.16)), refinements=(small,), left=Left(0.02, 5.0, "2 % remains."))
    told = notes(both)[1]
    assert (
        told.startswith("The sizes of backlash at gear_spring and sensor lag at gear_spring come to 18 %")
        and "98 %" in told
    )
    assert Effects.of(both).about_sizes == (told,)  # type: ignore[union-attr]
    assert not replace(both, effects=(replace(BACKLASH, size=0.9),)).about_sizes and not verdict(BACKLASH).about_sizes


def test_a_size_beside_more_that_remains_is_explained() -> None:
    """Seen: "size 100 %", "explains 100 % of the repeatable validation error", and three lines below "36 % of the mismatch remains"."""
    whole = replace(
        verdict(replace(BACKLASH, size=1.0)), left=Left(0.36, 5.4, "36 % of the mismatch remains in free runs.")
    )
    (told,) = whole.about_sizes
    assert told in notes(whole) and "windows, whose start states are estimated" in told and "free runs" in told
    shown = Effects.of(whole)
    assert shown is not None and (shown.cards[0].size, shown.cards[0].explained) == ("100 %", "64 %")
    assert not replace(whole, left=Left(0.05, 1.3, "5 % remains.")).about_sizes
    several = replace(verdict(replace(BACKLASH, size=0.8), replace(BACKLASH, size=0.7)), left=Left(0.02, 1.3, "2 %."))
    assert not several.about_sizes, "sizes of several need not add up"
    for left in (None, Left(1.2, 5.4, "As much remains.")):
        assert Effects.of(replace(whole, left=left)).cards[0].explained == ""  # type: ignore[union-attr]


def test_of_many_candidates_their_number_is_told() -> None:
    many = tuple((f"body_{k}", "constant_bias") for k in range(MOST_NAMED + 1))
    (told,) = NotTried((), many).sentences()
    assert told == "Not tried any more: 13 mechanisms at ports, which verdict.json lists (not_tried)."
    assert len(NotTried((), many).as_json()["candidates"]) == 13


def test_the_models_own_parameters_that_moved_are_listed() -> None:
    """Seen: values that came back to those of the machine, the best evidence, in the report alone."""
    stiff = Estimate("k", "N m/rad", 150.0, (193.0, 0.1), (178.7, 0.4))
    same = Estimate("mgl", "N m", 4.2, (4.1, 0.01), (4.201, 0.0001))
    vague = Estimate("b", "N m s/rad", 0.1, (0.1, None), (0.2, 0.5))
    unknown = Estimate("d", "N m s/rad", 0.2, (0.7, None), (0.25, None))
    found = replace(verdict(BACKLASH), parameters=(stiff, same, vague, unknown))
    assert moved_table(found)[1] == [
        ["k", 150.0, 193.0, 178.7, 0.4, "N m/rad"],
        ["d", 0.2, 0.7, 0.25, "", "N m s/rad"],
    ]
    assert moved_table(replace(found, parameters=(replace(stiff, augmented=None),)))[1] == []


BIAS = replace(
    BACKLASH, port="air_heat", mechanism="constant_bias", alternatives=(), separating_experiment="standstill"
)
MEMBERS = (
    Alternative("air_heat", "constant_bias", 0.33, "bias", 85.2, "W"),
    Alternative("actuator", "input_bias", 0.32, "bias", -0.0941, "", one_effect=True),
)


def test_hypotheses_that_are_one_effect_are_told_with_their_values_and_no_experiment() -> None:
    """Seen: an offset of a compressor and a constant heat, "to tell them apart: standstill and reversals"."""
    effect = replace(BIAS, one_of=OneOf("a constant offset", 0.65, MEMBERS))
    (told,) = [line for line in notes(verdict(effect)) if line.startswith("these recordings do not tell apart")]
    assert told == (
        "these recordings do not tell apart: constant bias at air_heat (0.33, bias = 85.2 W), input bias at actuator (0.32, bias = "
        f"-0.0941); in this model they are one effect: {DECIDED_BY}"
    )
    section = Effects.of(verdict(effect))
    assert section is not None
    (card,) = section.cards
    assert card.experiment == "" and card.one_effect == f"In this model they are one effect: {DECIDED_BY}"
    assert [share.value for share in card.shares] == ["bias = 85.2 W", "bias = -0.0941"]


def test_some_of_several_hypotheses_are_one_effect() -> None:
    other = Alternative("room_heat", "constant_bias", 0.2, "bias", 70.0, "W")
    effect = replace(BIAS, one_of=OneOf("a constant offset", 0.85, (*MEMBERS, other)))
    (told,) = [line for line in notes(verdict(effect)) if line.startswith("these recordings do not tell apart")]
    same = f"in this model constant bias at air_heat and input bias at actuator are one effect: {DECIDED_BY}"
    assert told.endswith(
        f"room_heat (0.2, bias = 70 W); {same}; to tell the others apart: standstill".replace("0.2,", "0.20,")
    )
    section = Effects.of(verdict(effect))
    assert section is not None and section.cards[0].experiment_tells == "What would tell the others apart"


def test_the_models_own_parameters_at_a_bound_are_told() -> None:
    """Seen: b = 0 with a standard deviation of 0.18 in a table, and nowhere that zero is its bound."""
    own = (
        Estimate("b", "N s/m", 2.0, (4.9, 0.1), (0.0, 0.2), (False, True)),
        Estimate("T", "s", 0.05, (0.005, 0.01), (0.008, 0.01), (True, False)),
        Estimate("M", "kg", 6.0, (6.5, 0.1), (7.0, 0.1)),
    )
    found, without = (replace(verdict(*effects), parameters=own) for effects in ((BACKLASH,), ()))
    told = f"{told_at_bound('b = 0 N s/m (with the effects) and T = 0.005 s (without the effects)')}."
    assert told in notes(found) and found.as_json()["at_bounds"] == [told]
    assert f"{told_at_bound('T = 0.005 s')}." in notes(without) and "at_bounds" not in verdict().as_json()
    at_card = replace(found, parameters=(Estimate("M", "kg", 5000.0, (5500.0, 2.0), (5500.0, 1.0), (True, True)),))
    (told,) = at_card.at_bounds  # seen: "M = 5500 kg and b_v = 0 N s/m (without the effects)", of a mass of 6000 kg
    assert told.startswith("At a bound: M = 5500 kg (without and with the effects);")
    assert (
        "With the effects M may go no further: if the truth lies beyond, effects and refinements make up for it" in told
    )
    small = replace(BACKLASH, parameters={"sharpness": {"value": 9.0}}, at_bounds=("sharpness",))
    assert any(told_law_at_bound("sharpness = 9") in line for line in notes(replace(found, refinements=(small,))))


def test_parameters_that_are_determined_together_alone_are_told() -> None:
    """Seen: b_v = 0 at its bound and b_m four times its start value, ± 2.6, of which only the sum is determined, without a word."""
    own = (
        Estimate("b_m", "N m s/rad", 0.05, (0.1, 0.1), (0.209, 2.6), together={"b_v": -0.998}),
        Estimate("b_v", "N s/m", 500.0, (0.0, 9.0), (400.0, 9.0), together={"b_m": -0.998}),
        Estimate("M", "kg", 5000.0, (5500.0, 2.0), (5500.0, 1.0), together={"d": 0.99}),
        Estimate("d", "N m s/rad", 600.0, (800.0, 2.0), (800.0, 1.0), together={"M": 0.99}),
    )
    found = replace(verdict(BACKLASH), parameters=own)
    (told,) = found.together
    assert told.startswith("Determined only together (correlation of the estimates): b_m and b_v -0.998. What one has")
    assert told in notes(found) and found.as_json()["together"] == [told]
    assert "together" not in replace(found, parameters=own[2:]).as_json()


def test_how_the_free_runs_of_a_verdict_begin_is_said() -> None:
    """Seen: 98.1 % in the table, 53.9 % of `compare` with the same model, and the reason in neither."""
    one = verdict()
    assert begun(one) == BEGINNINGS and begun(replace(one, complete=False)) == ""
    assert "that the card fixes are as it has them" in begun(one)
