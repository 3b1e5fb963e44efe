"""The sentences that speak for a verdict."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.describe import evidence
from greybox_torch.diagnosis.describe.effects import ceiling_share
from greybox_torch.diagnosis.describe.evidence import (
    _held_out,
    _removed,
    _step_sentence,
    ceiling_sentence,
    detection_sentences,
)
from greybox_torch.diagnosis.describe.residual_tests import Detection, Largest, Remains
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.select import remaining
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings

WHITE = Remains(Largest(0.01, 0.03), Largest(0.02, 0.05))
WRONG = Remains(Largest(0.93, 0.03), Largest(0.31, 0.05))
CALM, DRIVEN = Largest(0.01, 0.03), Largest(0.36, 0.03)


def test_before_and_after() -> None:
    found = [Detection("Steps", "speed", WRONG, WHITE, CALM, 40.0)]
    assert detection_sentences(found, True) == [
        "The free run's errors, model as it stands, are correlated with past inputs (largest correlation 0.31, 99 % bound 0.05); "
        "with the effects 0.02 (bound 0.05).",
        "They are not white (largest autocorrelation 0.93, 99 % bound 0.03); with the effects 0.01 (bound 0.03).",
    ]


def test_without_effects() -> None:
    assert detection_sentences([Detection("Steps", "speed", WHITE, WHITE, CALM, 40.0)], False) == [
        "The free run's errors, model as it stands, are not correlated with past inputs (largest correlation 0.02, 99 % bound 0.05).",
        "They are white (largest autocorrelation 0.01, 99 % bound 0.03).",
    ]


def test_the_clearest_of_several_and_feedback() -> None:
    found = [
        Detection("Steps", "speed", WHITE, WHITE, CALM, 40.0),
        Detection("Sweep", "speed", WRONG, WRONG, DRIVEN, 60.0),
        Detection("Sweep", "position", WHITE, WHITE, CALM, 60.0),
        Detection("Hold", "speed", WHITE, WHITE, Largest(0.1, 0.03), 50.0),
    ]
    past, colour, feedback = detection_sentences(found, False)
    assert "are correlated with past inputs up to 60 Hz (largest correlation 0.31" in past
    assert "not white" in colour
    assert past.endswith(", in speed of Sweep).") and colour.endswith(", in speed of Sweep).")
    assert feedback.startswith("What is new in the input is correlated with errors before it, in Sweep and Hold (")
    assert "0.36, 99 % bound 0.03" in feedback
    may = "may be recorded under feedback, or later than it acts (steps between samples), or samples of a sensor may be wrong"
    assert may in feedback, "seen: a clipped sensor, told as a recording under feedback"
    assert "Coherence above 60 Hz, where the input is hardly excited, is not counted as evidence." in feedback


def test_a_bound_of_one_or_more_judges_nothing() -> None:
    """Seen: "not correlated with past inputs (largest correlation 0.94, 99 % bound 1.5)"."""
    slow = Remains(Largest(0.01, 0.03), Largest(0.94, 1.5))
    (past, _) = detection_sentences([Detection("Steps", "speed", slow, slow, CALM, 40.0)], True)
    assert "cannot be judged from these recordings" in past and "0.94" in past and "1.5" not in past
    both = [Detection("Steps", "speed", one, slow, CALM, 40.0) for one in (slow, WHITE)]
    past, _ = detection_sentences(both, True)
    assert "99 % bound 0.05" in past and "with the effects 0.94 (which cannot be judged)" in past


@pytest.mark.parametrize(("value", "judged"), [(0.92, False), (0.97, True)])
def test_a_bound_that_hardly_any_correlation_exceeds_acquits_of_none(value: float, judged: bool) -> None:
    """Seen: "not correlated with past inputs (largest correlation 0.92, 99 % bound 0.96)", where an input was the whole error."""
    slow = Remains(Largest(0.01, 0.03), Largest(value, 0.96))
    (past, _) = detection_sentences([Detection("Zone", "air", slow, slow, CALM, 40.0)], False)
    assert ("are correlated with past inputs (largest correlation 0.97" in past) is judged
    assert ("cannot be judged from these recordings" in past) is not judged


def test_no_estimation_experiment_that_could_be_followed() -> None:
    assert detection_sentences([], True) == []


@pytest.mark.parametrize(
    ("named", "curves", "share"), [(0.9, (1.0, 0.5), 0.9), (1.2, (1.0,), 1.0), (1.2, (-0.1,), 1.0), (0.9, (), None)]
)
def test_share_of_the_ceiling(stub, named, curves, share) -> None:
    """The best free curve of the round is what any law of one signal could reach."""
    taken = stub(gain=named, unknown=False, plausible=0.0)
    others = [stub(gain=gain, unknown=True) for gain in curves]
    assert ceiling_share(stub(taken=taken, ranked=(taken, stub(gain=2.0, unknown=False), *others))) == share


def test_a_curve_is_its_own_ceiling(stub) -> None:
    curve = stub(gain=1.0, unknown=True)
    assert ceiling_share(stub(taken=curve, ranked=(curve,))) is None
    assert ceiling_share(stub(taken=None, ranked=(curve,))) is None


def test_ceiling_in_words(stub) -> None:
    told = ceiling_sentence(stub(mechanism="coulomb_friction", port="motor", ceiling=0.883))
    assert told.startswith("Coulomb friction at motor reaches 88 % of the ceiling: what the best free curve")


def test_an_interval_of_a_hundred_percent_is_not_told() -> None:
    """Seen: "removes 100.0 % ... (95 % interval 100.0 to 100.0 %)"."""
    assert _held_out(Gain(0.99999, 1e-6)) == ("more than 99.9 %", "")
    assert _held_out(Gain(0.98, 0.005)) == ("98.0 %", " (95 % interval 97.0 to 99.0 %)")


@pytest.mark.parametrize(
    ("share", "claimed"),
    [
        (
            0.01,
            "(12.8 standard errors). Less than 2 % of the mismatch was left, and there a further effect is a finding only if nothing "
            "but noise remains with it.",
        ),
        (0.3, "(12.8 standard errors); claimed is what exceeds 5 % and chance."),
    ],
)
def test_what_was_not_claimed_and_why(stub, monkeypatch: pytest.MonkeyPatch, share: float, claimed: str) -> None:
    """Seen: "would lower it by 68 % (12.8 standard errors); claimed is what exceeds 5 % and chance", and was not claimed."""
    monkeypatch.setattr(remaining, "remaining_share", lambda plain, parent, settings: share)
    monkeypatch.setattr(evidence, "least_gain", lambda fitted, settings: 0.05)
    monkeypatch.setattr(evidence, "_name", lambda attachment: "torque ripple at rotor")
    fitted = stub(fits=(stub(energies=np.ones(8)), stub(energies=np.ones(2))))
    best = stub(of_errors=1.14, significance=12.8, candidate=stub(attachment=None), fitted=fitted)
    step = stub(taken=None, ranked=(best,), parent=stub(effects=("friction",)))
    said = _step_sentence(step, stub(settings=DiagnosisSettings(), more_is_missing=False), stub())
    assert said == f"The best further candidate, torque ripple at rotor, would lower it by 68 % {claimed}"


def test_a_gain_over_few_windows_has_no_standard_error(stub, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: "would lower it by 1e+02 % (0.0 standard errors)", of 25 samples."""
    monkeypatch.setattr(evidence, "least_gain", lambda fitted, settings: 0.05)
    monkeypatch.setattr(evidence, "_name", lambda attachment: "sensor lag at thrust")
    best = stub(
        of_errors=6.0, significance=0.0, candidate=stub(attachment=None), fitted=stub(fits=(stub(energies=np.ones(1)),))
    )
    step = stub(taken=None, ranked=(best,), parent=stub(effects=()))
    said = _step_sentence(step, stub(settings=DiagnosisSettings(), more_is_missing=False), stub())
    assert "would lower it by 100 % (too few windows for a standard error)" in said


@pytest.mark.parametrize("plausible", [0.0, 0.2])
def test_a_gain_of_errors_is_told_apart_from_that_of_plausible_parameters(stub, monkeypatch, plausible) -> None:
    """The error is lower by a factor of 1.1; the rest of the gain is that a stiffness no longer vanishes."""
    monkeypatch.setattr(evidence, "_name", lambda attachment: "Coulomb asymmetry at motor")
    taken = RankedCandidate(stub(attachment=None), stub(), np.log(1.1) + plausible, 7.7, plausible=plausible)
    said = _step_sentence(stub(taken=taken, led=None), stub(), stub())
    lowers = "Coulomb asymmetry at motor lowers the mean squared error by a factor 1.1, 7.7 standard errors away from chance."
    assert said.startswith(lowers)
    assert said.endswith("more than ten times from where they began.") is bool(plausible)


def test_none_was_refitted_where_little_was_left(stub, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remaining, "remaining_share", lambda plain, parent, settings: 0.008)
    step = stub(taken=None, ranked=(), parent=stub(effects=("friction",)))
    said = _step_sentence(step, stub(settings=DiagnosisSettings(), more_is_missing=False), stub())
    assert (
        said
        == "Less than 2 % of the mismatch was left: no further candidate promised in the screen to leave noise alone."
    )


def test_names_in_whose_place_a_curve_stands_are_not_said_to_be_refuted(stub, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evidence, "_name", lambda attachment: f"{attachment.mechanism.name} at {attachment.port}")
    leak, lag, curve = (
        stub(port=port, mechanism=stub(name=name, free=name == "unknown"))
        for port, name in (("zone", "leak"), ("input", "lag"), ("zone", "unknown"))
    )
    state = stub(effects=(curve,))
    assert _removed([leak, lag], state) == [
        "A free curve stands in the place of leak at zone.",
        "Removed again, as other experiments or effects do not confirm it: lag at input.",
    ]
    assert _removed([], state) == []


def test_what_was_removed_several_times_is_told_once(stub) -> None:
    """Seen: "Removed again …: linear leak at block, actuator deadzone at actuator, linear leak at block, …", three times each."""
    leak = stub(port="block", mechanism=stub(name="linear_leak", free=False))
    (told,) = _removed([leak, leak, leak], stub(effects=()))
    assert told == "Removed again, as other experiments or effects do not confirm it: linear leak at block."


def test_steps_that_a_search_took_again_are_told_once(dead_zone_search, stub) -> None:
    """Seen: the same four steps three times over."""
    study, state = dead_zone_search.study, dead_zone_search.state
    step = SelectionStep((), state.plain, (), None)
    data = stub(held_out_by_default=False)
    told = evidence.sentences(data, study, replace(state, steps=(step, step)), (), {}, (), False)
    assert [line for line in told if "promised enough" in line] == [
        "No further candidate promised enough in the screen to be refitted."
    ]


def test_no_correlation_below_one_is_told_as_one() -> None:
    """Seen: "largest autocorrelation 1", of 0.9986."""
    slow = Remains(Largest(0.9986, 0.03), Largest(0.31, 0.05))
    _, colour = detection_sentences([Detection("Steps", "speed", slow, slow, CALM, 40.0)], True)
    assert colour == (
        "They are not white (largest autocorrelation above 0.99, 99 % bound 0.03); with the effects above 0.99 (bound 0.03)."
    )


def test_an_interval_of_a_share_ends_at_all_of_it() -> None:
    """Seen: "removes 97.4 % ... (95 % interval 94.6 to 100.3 %)"."""
    assert _held_out(Gain(0.974, 0.0148)) == ("97.4 %", " (95 % interval 94.5 to 100.0 %)")
