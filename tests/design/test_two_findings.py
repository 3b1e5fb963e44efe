"""The next recording after a diagnosis that found two effects, of which the first was taken when the second was still missing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.design_result import DesignResult
from greybox_torch.api.diagnosis_result import DiagnosisResult
from greybox_torch.api.expected import Expected, decided
from greybox_torch.api.hypotheses import _left, hypotheses_of, hypothesis_files, left_out_told, to_tell_apart
from greybox_torch.api.nothing_open import _better_known
from greybox_torch.diagnosis.describe.rivals import Rival
from greybox_torch.diagnosis.verdict import Left
from greybox_torch.errors import NothingToDo, UserError
from greybox_torch.mechanisms.actuator import InputBias
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown
from tests.diagnosis.test_verdict import BACKLASH

FIRST, SECOND = "rotor.coulomb_friction", "rotor.quadratic_drag"


@pytest.fixture
def two_found(undecided: DiagnosisResult) -> DiagnosisResult:
    """Dry friction, then a drag. A constant torque in place of the first was fitted without the drag, in place of the second with dry
    friction.
    """
    alone, torque = (replace(r, initial={"steps": {"speed": 9.0}}) for r in undecided.found.rivals)
    final = beside(alone, QuadraticDrag(), SECOND, 0.6)
    other = beside(alone, ConstantBias(), SECOND, 0.3)
    found = replace(undecided.found, model=final.model, values=dict(final.values), rivals=(alone, torque, final, other))
    return replace(undecided, found=found)


def beside(alone: Rival, law, finding: str, probability: float) -> Rival:
    """A hypothesis with dry friction and another law."""
    assert isinstance(alone.model, AugmentedModel)
    both = [Attachment("rotor", CoulombFriction()), Attachment("rotor", law)]
    made = AugmentedModel(alone.model.plain, both, alone.model.surroundings)
    held = {p.name: alone.values.get(p.name, p.value) for p in made.declared_parameters}
    return Rival(finding, "rotor", law.name, probability, made, held, {"steps": {"speed": 9.0}})


def test_hypotheses_differ_in_one_effect_and_begin_as_the_final_model(two_found: DiagnosisResult) -> None:
    group, left_out = to_tell_apart(hypotheses_of(two_found))
    assert [kept.name for kept in group] == ["quadratic drag at rotor", "constant bias at rotor"]
    assert group[0].model is two_found.model and group[0].starts == two_found.initial == {"steps": {"speed": 2.0}}
    assert [kept.name for kept in left_out] == ["constant bias at rotor"]
    (told,) = left_out_told(left_out)
    assert told.startswith("Left out is constant bias at rotor (probability 0.47), which was fitted when other effects")


def test_design_begins_as_the_final_model(two_found: DiagnosisResult) -> None:
    found = gt.design(two_found, seconds=0.5, limits={"speed": {"lower": -1e4, "upper": 1e4}})
    assert found.start == {"speed": 2.0} and len(found.left_out) == 1
    assert found.left_out[0] in found.notes


@pytest.mark.parametrize(
    ("in_verdict", "complete", "words"),
    [
        (
            0.97,
            True,
            r"already decided: quadratic drag at rotor has a probability of 0\.97, each rival less than 0\.005; expected",
        ),
        (0.5, True, r"leave quadratic drag at rotor alone .*is 0\.50 has another reason: as free runs leave 16 %"),
        (0.85, False, r"leave quadratic drag at rotor alone .*is 0\.85 has another reason: the search was stopped"),
    ],
)
def test_what_is_decided_is_not_recorded(two_found, tmp_path, in_verdict: float, complete: bool, words: str) -> None:
    """Seen: "a probability of 0.97", where the verdict says 0.85."""
    *_, final, other = two_found.found.rivals
    why = ("as free runs leave 16 %",)
    effects = (replace(BACKLASH, port=final.port, mechanism=final.mechanism, probability=in_verdict, limited=why),)
    verdict = replace(two_found.verdict, effects=effects, complete=complete)
    rivals = (replace(final, probability=0.97), replace(other, probability=1e-5))
    sure = replace(two_found, found=replace(two_found.found, verdict=verdict, rivals=rivals))
    with pytest.raises(NothingToDo, match=rf"nothing to design: .*{words}.*--precision PARAMETER") as told:
        gt.design(sure)
    assert in_verdict > 0.95 or "decided" not in str(told.value), "seen: already decided, with a probability of 0.50"
    files = hypothesis_files(tmp_path, sure, sure._checkpoint())
    kept = json.loads(files[tmp_path / "hypotheses.json"])
    assert [one["in_verdict"] for one in kept["findings"][0]] == [in_verdict, None] and kept["complete"] is complete
    assert [one.get("limited") for one in kept["findings"][0]] == [list(why), None]


def test_how_a_curve_becomes_better_known_is_told(two_found) -> None:
    """Seen: "nothing to design" of a curve that another recording would have told from one over another signal, and no word of how."""
    held = hypotheses_of(two_found)
    assert _better_known(held) == "", "laws, no curve"
    law, model = Attachment("rotor", Unknown("speed", 8)), two_found.model
    curve = AugmentedModel(model.plain, [law], model.surroundings)
    told = _better_known(replace(held, recommended=replace(held.recommended, model=curve)))
    assert (
        told.startswith(". The unknown effect at rotor is known better")
        and "in which speed goes over its whole" in told
    )


def test_what_is_left_all_the_same_is_told(two_found, tmp_path) -> None:
    """Seen: "there is nothing to record", where the verdict says that 51 times the noise is left, and repeatable."""
    *_, final, other = two_found.found.rivals
    left = Left(
        0.06,
        51.0,
        "6 % of the mismatch remains: in Exp. 2 51 times the noise. On the experiments that it was estimated from, all is well.",
    )
    verdict = replace(two_found.verdict, left=left)
    rivals = (replace(final, probability=0.97), replace(other, probability=1e-5))
    sure = replace(two_found, found=replace(two_found.found, verdict=verdict, rivals=rivals))
    with pytest.raises(
        UserError,
        match=r"leaves some error all the same\. 6 % of the mismatch remains: in Exp\. 2 51 times the noise\. No hypo",
    ):
        gt.design(sure)
    (tmp_path / "verdict.json").write_text(json.dumps(sure.content(tmp_path)))
    assert _left(tmp_path / "verdict.json") == left.sentence
    assert _left(tmp_path / "another.json") == ""
    little = replace(sure, found=replace(sure.found, verdict=replace(verdict, left=replace(left, times_noise=0.9))))
    with pytest.raises(UserError, match=r"each rival less than 0\.005; expected"):
        gt.design(little)


@pytest.mark.parametrize(
    ("probabilities", "is_decided"),
    [((0.97, 1e-5), True), ((0.96, 0.01), False), ((0.9, 1e-5), False), ((0.002, 0.96, 0.001), True)],
)
def test_decided(probabilities: tuple[float, ...], is_decided: bool) -> None:
    assert decided(probabilities) is is_decided


def test_nothing_is_asked_for_where_nothing_is_told_apart(undecided: DiagnosisResult, tmp_path: Path) -> None:
    """One of two hypotheses could be excluded, the other not: that is no decision, and the sentences have to agree on it."""
    found = gt.design(undecided, seconds=0.5)
    nats = np.array([[0.0, 26.0], [2.5, 0.0]])
    alike: DesignResult = replace(found, expected=Expected((0.5, 0.47), nats, nats))
    assert "tells these hypotheses apart, whichever is right: " in alike.sentence
    told = " ".join(alike.notes)
    assert "not worth recording" in told
    assert not any(words in told for words in ("Record it", "random multisine", "No input"))


def test_what_is_next_to_nothing_decides_nothing() -> None:
    """Two that stay alike hold all the probability: a third that is told from them makes no decision."""
    nats = np.array([[0.0, 0.1, 400.0], [0.6, 0.0, 400.0], [400.0, 400.0, 0.0]])
    assert not Expected((0.49, 0.48, 1e-6), nats, None).decides
    assert Expected((0.49, 0.28, 0.2), nats, None).decides
    assert Expected((0.9, 1e-4, 1e-6), nats, None).decides


def test_groups_that_are_told_apart_are_told_as_groups(undecided: DiagnosisResult) -> None:
    """Seen: "the right one of 5 hypotheses to a probability of 0.97", and below it which of them no input tells apart."""
    found = gt.design(undecided, seconds=0.5)
    nats = np.array([[0.0, 0.2, 900.0], [70000.0, 0.0, 800.0], [700.0, 600.0, 0.0]])
    names = ("bias", "friction", "drag")
    told = replace(found, names=names, expected=Expected((0.8, 0.1, 0.07), nats, nats))
    assert told.expected.groups == [[0, 1], [2]] and told.expected.by_groups
    assert "tell two groups of hypotheses apart: bias or friction; drag." in told.sentence
    assert "no more than the first one has" not in told.sentence and "Within a group no input" in told.sentence
    heads, rows = told._table()
    assert heads[0] == "group" and [row[3:] for row in rows] == [[900.0, 0.2], [800.0, 70000.0], [600.0, ""]]
    assert any("as well as the designed one" in line for line in told.notes)
    assert not any("No input" in line for line in told.notes)
    known = replace(told, expected=Expected((0.87, 0.1, 0.005), nats, None))
    assert "0.97, which is no more than the first one has today (0.97)" in known.sentence


def test_without_groups_each_pair_is_told() -> None:
    apart = Expected((0.6, 0.3, 0.07), np.array([[0.0, 9.0, 9.0], [9.0, 0.0, 9.0], [9.0, 9.0, 0.0]]), None)
    assert not apart.by_groups and [len(group) for group in apart.groups] == [1, 1, 1]
    chain = Expected((0.6, 0.3, 0.07), np.array([[0.0, 0.1, 9.0], [9.0, 0.0, 0.1], [9.0, 9.0, 0.0]]), None)
    assert not chain.by_groups and chain.groups == [[0, 1, 2]] and not chain.decides


def test_no_more_than_is_known_is_no_promise(undecided: DiagnosisResult) -> None:
    """Seen: "expected to bring the right one of 4 hypotheses to a probability of 0.97", of three that count as one and have it today."""
    found = gt.design(undecided, seconds=0.5)
    nats = np.array(
        [[0.0, 0.7, 0.8, 900.0], [2.0, 0.0, 5.0, 900.0], [0.9, 5.0, 0.0, 900.0], [900.0, 900.0, 900.0, 0.0]]
    )
    chain = replace(found, names=("a", "b", "c", "d"), expected=Expected((0.46, 0.46, 0.05, 1e-9), nats, nats))
    assert "tells these hypotheses apart, whichever is right: a, b, c." in chain.sentence
    two = np.array([[0.0, 9.0], [9.0, 0.0]])
    known = replace(found, expected=Expected((0.965, 0.02), two, two))
    assert "which is no more than Coulomb friction at rotor has today (0.97)" in known.sentence
    for one in (chain, known):
        told = " ".join(one.notes)
        assert "not worth recording" in told and "Record it" not in told
        assert one.content(Path("next"))["worth_recording"] is False


def instead(alone: Rival, finding: str, probability: float, *laws) -> Rival:
    """A hypothesis with other laws, (port, law) each, of which the last one is of the finding."""
    assert isinstance(alone.model, AugmentedModel)
    made = AugmentedModel(alone.model.plain, [Attachment(*law) for law in laws], alone.model.surroundings)
    held = {p.name: alone.values.get(p.name, 0.2 if "bias" in p.name else p.value) for p in made.declared_parameters}
    return Rival(finding, laws[-1][0], laws[-1][1].name, probability, made, held, alone.initial)


TORQUE, VOLTAGE, DRAG = ("rotor", ConstantBias()), ("actuator", InputBias()), ("rotor", QuadraticDrag())


def test_hypotheses_that_are_one_effect_are_no_matter_of_a_recording(undecided: DiagnosisResult) -> None:
    """Seen: "No input within the limits was found … Wider limits or more seconds may help", of two names of one constant torque."""
    alone = undecided.found.rivals[0]
    torque, voltage = instead(alone, FIRST, 0.5, TORQUE), instead(alone, FIRST, 0.46, VOLTAGE)
    found = replace(undecided.found, model=torque.model, values=dict(torque.values), rivals=(torque, voltage))
    told = "constant bias at rotor and input bias at actuator are one effect in this model, whatever the input"
    with pytest.raises(UserError, match=told):
        gt.design(replace(undecided, found=found))
    friction = replace(alone, probability=0.3)
    of_three = gt.design(replace(undecided, found=replace(found, rivals=(torque, voltage, friction))), seconds=0.5)
    assert any(told in line for line in of_three.notes)


def test_another_finding_is_designed_for_where_one_is_no_matter_of_a_recording(undecided: DiagnosisResult) -> None:
    alone = undecided.found.rivals[0]
    torque, voltage = instead(alone, FIRST, 0.5, DRAG, TORQUE), instead(alone, FIRST, 0.46, DRAG, VOLTAGE)
    drag = instead(alone, SECOND, 0.6, TORQUE, DRAG)
    friction = instead(alone, SECOND, 0.3, TORQUE, ("rotor", CoulombFriction()))
    rivals = (torque, voltage, drag, friction)
    found = replace(undecided.found, model=drag.model, values=dict(drag.values), rivals=rivals)
    group, _ = to_tell_apart(hypotheses_of(replace(undecided, found=found)))
    assert [kept.name for kept in group] == ["quadratic drag at rotor", "Coulomb friction at rotor"]
    alone_open = replace(found, rivals=(torque, voltage, drag))
    group, _ = to_tell_apart(hypotheses_of(replace(undecided, found=alone_open)))
    assert group[0].name == "constant bias at rotor"
