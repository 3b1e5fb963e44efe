"""What the recommended model leaves: how much on validation, and what it is like where it was estimated."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe import left
from greybox_torch.diagnosis.describe.left import what_is_left


@pytest.mark.parametrize(
    ("past", "colour", "words"),
    [
        (True, True, "the error is correlated with past inputs, so that part of it is repeatable."),
        (
            False,
            True,
            "the error is not white, and past inputs do not explain it linearly: look at it over time (greybox residuals) for what is not "
            "recorded, such as a load, or for a state that it follows.",
        ),
        (False, False, "the error is white, as noise is."),
    ],
)
def test_size_and_kind_of_error_are_each_told_of_their_experiments(stub, past, colour, words) -> None:
    """Seen: "its error is 105 times the noise, and it is white": the one on a validation experiment, the other on the estimation ones."""
    judged = stub(left=lambda effects: (0.634, 105.3, "Validation 1"))
    found = [stub(final=stub(past=stub(beyond=past, judged=True), colour=stub(beyond=colour)))]
    left = what_is_left(judged, found, True, 1.3)
    assert (left.share, left.times_noise) == (0.634, 105.3)
    assert left.sentence == (
        "63 % of the mismatch remains in free runs: in Validation 1 the free run's error is 110 times the noise (read from the "
        "recordings' highest frequencies). "
        f"On the experiments that it was estimated from, {words}"
    )


def test_past_inputs_are_not_acquitted_where_they_cannot_be_judged(stub) -> None:
    judged = stub(left=lambda effects: (0.634, 105.3, "Validation 1"))
    found = [stub(final=stub(past=stub(beyond=False, judged=False), colour=stub(beyond=True)))]
    assert "white, and whether past inputs explain it linearly cannot be judged: look" in (
        what_is_left(judged, found, True, 1.3).sentence
    )


def test_an_error_of_the_size_of_the_noise(stub) -> None:
    """Seen: "is 1 times the noise"."""
    left = what_is_left(stub(left=lambda effects: (0.01, 1.02, "Run 2")), [], True, 1.3)
    assert (
        "in Run 2 the free run's error is as large as the noise (read from the recordings' highest frequencies)."
        in left.sentence
    )


def test_an_error_far_below_the_noise_says_that_this_is_none(stub) -> None:
    """Seen: "the free run's error is 0.04 times the noise"."""
    told = what_is_left(stub(left=lambda effects: (0.03, 0.04, "Run 2")), [], True, 1.3).sentence
    assert told.startswith(
        "3 % of the mismatch remains in free runs: in Run 2 the free run's error is far smaller than what was taken for noise (read from "
        "the recordings' highest frequencies), which cannot be read from these recordings"
    )
    assert (
        "0.6 times the noise" in what_is_left(stub(left=lambda effects: (0.03, 0.6, "Run 2")), [], True, 1.3).sentence
    )


@pytest.mark.parametrize(
    ("share", "words"), [(3.2e-7, "Less than 0.01 %"), (0.0, "Less than 0.01 %"), (0.0123, "1.2 %"), (2.5, "250 %")]
)
def test_shares_are_plain_numbers(stub, share, words) -> None:
    """Seen: "2.2e-05 % of the mismatch remains"."""
    left = what_is_left(stub(left=lambda effects: (share, 2.0, "Run 2")), [], True, 1.3)
    assert left.sentence.startswith(f"{words} of the mismatch remains")


def test_much_that_remains_and_is_noise_is_told_as_such(stub) -> None:
    """Seen: "26 % of the mismatch remains … 1.2 times the noise", which read as a contradiction."""
    left = what_is_left(stub(left=lambda effects: (0.26, 1.2, "Run 2")), [], True, 1.3)
    assert left.sentence.startswith(
        "26 % of the mismatch remains in free runs, most of it noise: in Run 2 the free run's error is 1.2 times"
    )
    for share, times in ((0.26, 1.5), (0.26, np.nan), (0.01, 1.2)):
        assert (
            "most of it"
            not in what_is_left(stub(left=lambda effects, s=share, t=times: (s, t, "Run 2")), [], True, 1.3).sentence
        )


@pytest.mark.parametrize(("past", "colour", "told"), [(False, True, True), (True, True, True), (False, False, False)])
def test_what_would_take_up_much_of_it_is_told_instead_of_a_load(stub, past: bool, colour: bool, told: bool) -> None:
    """Seen: an inverter's lag in the evidence alone, 51 % and 16.5 standard errors, and the advice to look for a load."""
    found = [stub(final=stub(past=stub(beyond=past, judged=True), colour=stub(beyond=colour)))]
    judged = stub(left=lambda effects: (0.002, 6.0, "Run 2"))
    sentence = what_is_left(judged, found, True, 1.3, further="input lag at motor would take up 51 % of it").sentence
    assert sentence.endswith("part of it is repeatable: input lag at motor would take up 51 % of it.") is told
    assert "such as a load" not in sentence


def test_where_noise_is_not_known(stub) -> None:
    left = what_is_left(stub(left=lambda effects: (1.0, np.nan, "")), [], False, 1.3)
    assert left.sentence.startswith(
        "The model as it stands is recommended: how much of its error is noise is not known."
    )


@pytest.mark.parametrize(
    ("times", "coloured", "words"),
    [
        (1.03, True, "not white: steps of a sensor, the timing of samples or start states may leave as much."),
        (1.03, False, "white, as noise is."),
        (1.4, True, "correlated with past inputs, so that part of it is repeatable."),
    ],
)
def test_hardly_more_than_noise_is_not_told_as_something_repeatable(stub, times: float, coloured: bool, words) -> None:
    """Seen: "nothing is missing (0.95)", and "correlated with past inputs, so that part of it is repeatable" at 0.65 times the noise."""
    kind = stub(final=stub(past=stub(beyond=coloured, judged=True), colour=stub(beyond=coloured)))
    left = what_is_left(stub(left=lambda effects: (1.0, times, "Validation 1")), [kind], False, 1.3)
    assert left.sentence.endswith(f"the error is {words}")


@pytest.mark.parametrize(("over_windows", "share", "told"), [(1.1, 0.4, True), (1.1, 0.01, False), (2.0, 0.4, False)])
def test_free_runs_that_nothing_could_follow_are_said_to_be_so(stub, over_windows, share, told) -> None:
    """Seen: a stage that slips into another well of its cogging, sent to look for "what is not recorded, such as a load"."""
    runs = stub(parted=lambda final, comparison, asked: dict.fromkeys(asked, share))
    judged = stub(
        left=lambda effects: (0.4, 275009.9, "Run 3"),
        free_runs=runs,
        augmented=None,
        with_effects=None,
        settings=stub(least_parted=0.1),
    )
    found = [stub(final=stub(past=stub(beyond=False, judged=True), colour=stub(beyond=True)))]
    sentence = what_is_left(judged, found, True, 1.3, over_windows=over_windows).sentence
    assert ("no free run follows it" in sentence) is told
    assert ("not recorded, such as a load" in sentence) is not told


@pytest.mark.parametrize(
    ("fit", "told"),
    [
        (-73.0, "free runs of the validation experiments have a mean fit of -73.0 %, worse than a constant: in Run 2"),
        (
            -4321.0,
            "free runs of the validation experiments have a mean fit of below -1000 %, worse than a constant: in",
        ),
        (-np.inf, "free runs of the validation experiments overflow: in Run 2"),
        (12.0, "1.7 % of the mismatch remains in free runs: in Run 2"),
    ],
)
def test_little_of_a_mismatch_of_runs_that_are_lost_is_not_told_as_little(stub, fit: float, told: str) -> None:
    """Seen: "1.7 % of the mismatch remains" beside a validation fit of -73 %, where the model as it stands had -1619 %."""
    left = what_is_left(stub(left=lambda effects: (0.017, 150.0, "Run 2")), [], True, 1.3, fits=(-80.0, fit))
    assert told in left.sentence and left.share == 0.017
    assert ("of the mismatch remains" in left.sentence) is (fit >= 0.0)


def test_no_share_is_told_of_the_error_of_a_model_that_runs_away(stub) -> None:
    """Seen: "less than 0.01 % of the mismatch remains", of a validation fit of -798262 %, beside 130 times the noise."""
    judged = stub(left=lambda effects: (6e-10, 126.4, "C"))
    told = what_is_left(judged, [], True, 1.3, fits=(-798262.4, 71.6)).sentence
    assert "have a mean fit of 71.6 %; those of the model without it run away" in told and "130 times the noise" in told
    assert "0.01" not in told
    assert "Less than 0.01 %" in what_is_left(judged, [], True, 1.3, fits=(-40.0, 99.9)).sentence


@pytest.mark.parametrize(
    ("errors", "noise", "told"),
    [
        ((0.1, 1e-3), (0.1, 1e-5), ", nearly all of it in position."),
        ((0.1, 1e-3), (1e-3, 1e-5), "."),  # both alike
        ((0.1, 1e-3), (np.nan, 1e-5), ", nearly all of it in position."),
        ((0.1, 0.0), (np.nan, np.nan), "."),
        ((0.1,), (1e-4,), "."),  # there is but one
    ],
)
def test_the_output_that_nearly_all_is_left_of_is_named(stub, monkeypatch, errors, noise, told) -> None:
    """Seen: "150 times the noise", and not of which of two sensors."""
    names = ["speed", "position"][: len(errors)]
    scores = [stub(experiment=e, output=n, rmse=r) for e in ("A", "B") for n, r in zip(names, errors, strict=True)]
    judged = stub(
        left=lambda effects: (0.634, 105.3, "B"),
        with_effects=stub(scores=scores),
        recordings=[stub(name="A"), stub(name="B")],
        problem=stub(model=stub(outputs=[stub(name=n) for n in names])),
        settings=None,
    )
    monkeypatch.setattr(left, "output_floors", lambda problem, settings: np.array([noise, noise]) ** 2)
    output = left.in_one_output(judged, True)
    assert f"highest frequencies){told} On" in what_is_left(judged, [], True, 1.3, output=output).sentence
