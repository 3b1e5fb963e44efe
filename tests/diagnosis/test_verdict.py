"""The verdict in words and in JSON."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.api.verdict_summary import effect_table
from greybox_torch.diagnosis.effect import Curve, Effect
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.verdict import Left, Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.report.sections.effects import Effects

BACKLASH = Effect(
    port="gear_spring",
    mechanism="backlash",
    probability=0.94,
    signals=("gear_twist",),
    where="|gear_twist| < 0.031 rad",
    parameters={"half_gap": {"value": 0.031, "std": 0.0004, "unit": "rad"}},
    explained=0.97,
    alternatives=(Alternative("gear_spring", "nonlinear_stiffness", 0.04),),
    curve=None,
    size=0.9,
)
CURVE = Curve("speed", "rad/s", np.array([0.0, 1.0]), np.array([0.0, 0.5]), "N m")


def scores(fit: float) -> tuple[Score, ...]:
    return (Score("Run 1", "estimation", "speed", fit, 0.2), Score("Run 2", "validation", "speed", fit - 1.0, 0.3))


def verdict(*effects: Effect, complete: bool = True) -> Verdict:
    return Verdict(
        dataset="made",
        model="Motor",
        seed=3,
        seconds=1.5,
        confidence=0.95,
        effects=effects,
        scores={"start": scores(70.0), "refit": scores(80.0), "augmented": scores(90.0)},
        evidence=("something",),
        stages={"searching": 1.0},
        ranking=(),
        complete=complete,
    )


def test_parameters_of_an_effect_say_which_there_are() -> None:
    """Seen: a bare KeyError of "half_widht", where those of a model have a hint."""
    with pytest.raises(KeyError, match=r'did you mean "half_gap"\?\); there are: half_gap'):
        BACKLASH.parameters["half_gpa"]
    assert json.loads(json.dumps(BACKLASH.as_json()["parameters"])) == dict(BACKLASH.parameters)


def test_keys_are_those_of_the_contract() -> None:
    found = json.loads(json.dumps(verdict(BACKLASH).as_json()))
    agreed = {"schema", "dataset", "model", "seed", "seconds", "mismatch", "confidence", "effects", "fit"}
    assert agreed <= set(found)
    assert found["schema"] == "greybox-verdict/2"
    assert (found["dataset"], found["model"], found["seed"], found["mismatch"]) == ("made", "Motor", 3, True)
    assert found["effects"] == [
        {
            "port": "gear_spring",
            "mechanism": "backlash",
            "probability": 0.94,
            "size": 0.9,
            "signals": ["gear_twist"],
            "where": "|gear_twist| < 0.031 rad",
            "parameters": {"half_gap": {"value": 0.031, "std": 0.0004, "unit": "rad"}},
            "explained": 0.97,
            "alternatives": [{"port": "gear_spring", "mechanism": "nonlinear_stiffness", "probability": 0.04}],
        }
    ]
    assert found["fit"][1] == {
        "experiment": "Run 2",
        "role": "validation",
        "output": "speed",
        "start": {"fit": 69.0, "rmse": 0.3},
        "refit": {"fit": 79.0, "rmse": 0.3},
        "augmented": {"fit": 89.0, "rmse": 0.3},
    }


def test_an_equation_comes_with_what_it_holds_with_and_waves_with_their_size() -> None:
    """Seen: `port.air += -140 * wind * (air - outside)` in the file, without the U beside which it holds."""
    amplitudes = {name: {"value": 0.02, "std": 0.001, "unit": "rad"} for name in ("a", "b", "a_2", "b_2")}
    effect = replace(
        BACKLASH,
        parameters=amplitudes,
        equation="port.air += -140 * wind",
        of_line="a straight line, with U = 1260 W/K beside it",
        shared="the model's U does what such a curve can do as well",
        amplitudes={"b": (0.03, 0.001), "b_2": (0.02, None)},
    )
    (found,) = json.loads(json.dumps(verdict(effect).as_json()))["effects"]
    assert (found["of_equation"], found["shared"]) == (effect.of_line, effect.shared)
    assert found["amplitudes"] == [
        {"of": ["a", "b"], "value": 0.03, "std": 0.001, "unit": "rad"},
        {"of": ["a_2", "b_2"], "value": 0.02, "std": None, "unit": "rad"},
    ]


def test_share_of_the_ceiling_where_it_is_known() -> None:
    first, second = verdict(BACKLASH, replace(BACKLASH, ceiling=0.9)).as_json()["effects"]
    assert "ceiling" not in first and second["ceiling"] == 0.9


def test_what_cannot_be_told_apart_is_the_headline() -> None:
    members = (Alternative("gear_spring", "backlash", 0.6), Alternative("arm_spring", "backlash", 0.35))
    whole = OneOf("a coupling that is no linear spring at gear_spring or arm_spring", 0.95, members)
    told = verdict(replace(BACKLASH, probability=0.6, one_of=whole))
    assert told.sentence.startswith(
        "The mismatch: a coupling that is no linear spring at gear_spring or arm_spring "
        "(probability 0.95, backlash at gear_spring 0.60); with it"
    )
    listed = replace(whole, statement="backlash at gear_spring, or backlash at arm_spring")
    assert replace(BACKLASH, one_of=listed).headline.endswith("at arm_spring (probability 0.95, the first 0.60)")
    (effect,) = json.loads(json.dumps(told.as_json()))["effects"]
    assert effect["probability"] == 0.6
    assert effect["one_of"] == {
        "statement": "a coupling that is no linear spring at gear_spring or arm_spring",
        "probability": 0.95,
        "members": [
            {"port": "gear_spring", "mechanism": "backlash", "probability": 0.6},
            {"port": "arm_spring", "mechanism": "backlash", "probability": 0.35},
        ],
    }


def test_refinements_and_what_is_left_stand_beside_the_findings() -> None:
    small = replace(BACKLASH, port="motor", mechanism="coulomb_friction", size=0.003)
    left = Left(0.04, 2.1, "4 % of the mismatch remains.")
    told = replace(verdict(BACKLASH), refinements=(small,), left=left)
    found = json.loads(json.dumps(told.as_json()))
    assert [e["mechanism"] for e in found["effects"]] == ["backlash"]
    (refinement,) = found["refinements"]
    assert (refinement["port"], refinement["mechanism"], refinement["size"]) == ("motor", "coulomb_friction", 0.003)
    told_so = "Coulomb friction at motor (half_gap = 0.031 rad) accounts for 0.3 % of the whole mismatch"
    assert refinement["sentence"].startswith(told_so)
    assert found["left"] == {"share": 0.04, "times_noise": 2.1, "sentence": "4 % of the mismatch remains."}
    assert "coulomb" not in told.sentence


def test_refinements_alone_are_no_mismatch() -> None:
    assert replace(verdict(), refinements=(replace(BACKLASH, size=1e-4),)).mismatch is False


def test_nothing_missing() -> None:
    found = verdict().as_json()
    assert (found["mismatch"], found["effects"]) == (False, [])
    assert found["evidence"] == ["something"]
    assert verdict().sentence == "Nothing is missing from Motor that these recordings can show (confidence 0.95)."


def test_only_unknown_carries_its_curve() -> None:
    named, unknown = replace(BACKLASH, curve=CURVE), replace(BACKLASH, mechanism="unknown", curve=CURVE)
    found = json.loads(json.dumps(verdict(named, unknown).as_json()))["effects"]
    assert "curve" not in found[0]
    assert found[1]["curve"] == {
        "signal": "speed",
        "unit": "rad/s",
        "values": [0.0, 1.0],
        "force": [0.0, 0.5],
        "force_unit": "N m",
    }
    multiplied = replace(unknown, curve=replace(CURVE, factor=Factor("chamber - lining", "degC", 94.7)))
    more = {"factor": "chamber - lining", "factor_value": 94.7, "factor_unit": "degC"}
    assert multiplied.as_json()["curve"] == found[1]["curve"] | more


@pytest.mark.parametrize(
    ("effects", "words"),
    [
        ((BACKLASH,), "The mismatch is backlash at gear_spring (probability 0.94); with it the validation fit goes"),
        (
            (BACKLASH, replace(BACKLASH, mechanism="unknown")),
            "backlash at gear_spring (probability 0.94), and an unknown",
        ),
    ],
)
def test_sentence(effects, words) -> None:
    assert words in verdict(*effects).sentence
    assert verdict(*effects).sentence.endswith("goes from 79.0 % to 89.0 %.")


def test_a_search_that_was_stopped_does_not_say_nothing() -> None:
    assert "no answer yet" in verdict(complete=False).sentence


def test_the_sentence_of_a_search_that_was_stopped_says_so() -> None:
    """Seen from Python: "an unknown effect at air (probability 0.50)", where the whole search says 0.97, and no sign of a time limit."""
    assert verdict(BACKLASH, complete=False).sentence.endswith("to 89.0 %; so far, as the search was stopped.")


def test_experiments_that_no_free_run_follows_are_named_and_do_not_count() -> None:
    with_run_3 = {
        stage: (*rows, Score("Run 3", "validation", "speed", 10.0 if stage == "augmented" else 60.0, 0.3))
        for stage, rows in verdict().scores.items()
    }
    told = replace(verdict(BACKLASH), scores=with_run_3, unstable=frozenset({"Run 3"}))
    assert told.as_json()["unstable"] == ["Run 3"]
    assert told.sentence.endswith("goes from 79.0 % to 89.0 % (without Run 3, which no free run follows).")
    assert "unstable" not in verdict(BACKLASH).as_json()


def test_what_an_unknown_effect_is_instead_of_a_curve_is_in_its_headline() -> None:
    fading = replace(
        BACKLASH, port="actuator", mechanism="unknown", law="unknown_fading", form="a gain that fades as it is used"
    )
    assert fading.headline == "an unknown effect at actuator, a gain that fades as it is used (probability 0.94)"
    assert fading.prefix == "actuator.unknown_fading" and BACKLASH.prefix == "gear_spring.backlash"
    mapped = replace(fading, parameters={n: {"value": 1.0} for n in ("w_0_0", "first_input", "spacing_speed", "T")})
    assert list(mapped.shown_parameters) == ["T"]


@pytest.mark.parametrize(("second", "words"), [(97.0, "its error, mostly in speed, is"), (70.0, "its error is")])
def test_where_the_error_without_a_name_is(second: float, words: str) -> None:
    """Seen: a fan whose speed fits to 72 % and whose temperature to 97 %: the sentence named neither."""
    both = tuple(Score("Run 2", "validation", name, fit, 0.3) for name, fit in (("speed", 72.0), ("heat", second)))
    short = replace(verdict(), unexplained=12.0, too_short="the recording is too short to judge").sentence
    assert "No law" not in short and short.endswith("What it is cannot be told: the recording is too short to judge.")
    told = replace(verdict(), unexplained=12.0, scores={"start": both, "refit": both, "augmented": both}).sentence
    assert (
        f"Something is missing from Motor: {words} at least 12 times the noise (read from the recordings' highest frequencies), over short "
        "windows and in free runs alike." in told
    )


def test_the_largest_effect_is_shown_first() -> None:
    """Seen: a report that began with a lag of size 0.6 %, before a dead zone of 31 % and a friction of 34 %."""
    small = replace(BACKLASH, port="motor", mechanism="input_lag", size=0.006)
    unknown = replace(BACKLASH, port="arm", mechanism="gravity", size=float("nan"))
    found = verdict(unknown, small, BACKLASH)
    assert [e.port for e in found.shown_effects] == ["gear_spring", "motor", "arm"]
    assert found.sentence.startswith("The mismatch is backlash at gear_spring (probability 0.94), input lag at motor")
    assert [e["port"] for e in found.as_json()["effects"]] == ["arm", "motor", "gear_spring"], "as they were found"
    assert [row[0] for row in effect_table(found)[1]] == ["gear_spring", "motor", "arm"]
    section = Effects.of(found)
    assert section is not None and [card.port for card in section.cards] == ["gear_spring", "motor", "arm"]
