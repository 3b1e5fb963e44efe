"""How many names may stand for a free curve."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.select import forward, names_for_curve
from greybox_torch.diagnosis.select.forward import _name_before_fine_curve, _stands_again, _without_curves
from greybox_torch.diagnosis.select.names_for_curve import as_far_as_curve, before_pieces, in_pieces, within_reach
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.stopping import result_of


@pytest.mark.parametrize(
    ("ports", "pieces"),
    [(["pivot", "pivot"], False), (["pivot", "pivot", "arm"], False), (["pivot", "pivot", "pivot"], True)],
)
def test_more_than_two_names_at_the_place_of_a_curve_are_pieces_of_it(monkeypatch, stub, ports, pieces) -> None:
    """Seen: a slack spring, outside the library, told as gravity, a stop, a bias and a ripple at the pivot."""
    monkeypatch.setattr(names_for_curve, "_joined_with", lambda study, port: {port})
    law = stub(needs=())
    before, added = stub(port="pivot", mechanism=law), [stub(port=port, mechanism=law) for port in ports]
    taken = stub(candidate=stub(attachment=stub(port="pivot", mechanism=stub(signal="deflection"))))
    with_curve = stub(steps=(stub(parent=stub(effects=(before,)), taken=taken),))
    branch = stub(effects=(before, *added))
    assert in_pieces(stub(settings=DiagnosisSettings()), with_curve, branch) is pieces  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("signals", "further", "pieces"),
    [
        ((("level",), ("level",)), 5.0, True),
        ((("level",), ("level",)), 2.0, False),
        ((("level",), ()), 5.0, False),
        ((("level",),), 5.0, False),
    ],
)
def test_two_names_of_the_curves_own_signal_stand_only_where_the_curve_takes_up_no_more(
    monkeypatch, stub, signals, further, pieces
) -> None:
    """Seen: the transpiration of plants, outside the library, told as a leak and a flow above a threshold (0.97 each)."""
    monkeypatch.setattr(names_for_curve, "window_significance", lambda before, after, settings: further)
    monkeypatch.setattr(names_for_curve, "_joined_with", lambda study, port: {port})
    curve = stub(port="air", mechanism=stub(signal="level"))
    taken = stub(candidate=stub(attachment=curve))
    with_curve = stub(steps=(stub(parent=stub(effects=()), taken=taken),), current=stub(score=-2.2))
    added = tuple(stub(port="air", mechanism=stub(needs=needs)) for needs in signals)
    branch = stub(effects=added, current=stub(score=-2.1))
    study = stub(settings=DiagnosisSettings())
    assert in_pieces(study, with_curve, branch) is pieces  # type: ignore[arg-type]
    better = stub(effects=added, current=stub(score=-2.3))
    assert in_pieces(study, with_curve, better) is False  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("names", "score", "as_far"), [(2, -1.9, True), (3, -1.9, False), (3, -2.05, False), (3, -2.15, True)]
)
def test_more_than_two_names_wherever_they_are_have_to_come_farther_than_the_curve(
    monkeypatch, stub, names: int, score: float, as_far: bool
) -> None:
    """Seen: the heat of shear in an extruder, told as a lag of the room's temperature (0.97) beside the curve (0.50), after 137 s."""
    monkeypatch.setattr(names_for_curve, "alone_at_noise", lambda *_: False)
    monkeypatch.setattr(names_for_curve, "_joined_with", lambda study, port: {port})
    taken = stub(candidate=stub(attachment=stub(port="zone", mechanism=stub(signal="level"))))
    before = stub(effects=(), score=0.0)
    with_curve = stub(steps=(stub(parent=before, taken=taken),), current=stub(score=-2.0), plain=before)
    added = tuple(stub(port=f"elsewhere{k}", mechanism=stub(needs=())) for k in range(names))
    branch = stub(effects=added, current=stub(score=score))
    assert as_far_as_curve(stub(settings=DiagnosisSettings()), with_curve, branch) is as_far  # type: ignore[arg-type]


@pytest.mark.parametrize(("joined", "pieces"), [({"camera", "rotor"}, True), ({"camera"}, False)])
def test_names_at_both_ends_of_a_spring_are_pieces_of_a_curve_at_one(monkeypatch, stub, joined, pieces) -> None:
    """Seen: a cable harness on a camera, told as gravity at the camera and a stop at the motor that turns it by a spring (0.97 each)."""
    monkeypatch.setattr(names_for_curve, "window_significance", lambda before, after, settings: 5.0)
    monkeypatch.setattr(names_for_curve, "joined_bodies", lambda model: [[stub(name=name) for name in joined]])
    taken = stub(candidate=stub(attachment=stub(port="camera", mechanism=stub(signal="position"))))
    with_curve = stub(steps=(stub(parent=stub(effects=()), taken=taken),), current=stub(score=-2.2))
    added = tuple(stub(port=port, mechanism=stub(needs=("position",))) for port in ("camera", "rotor"))
    study = stub(settings=DiagnosisSettings(), problem=stub(model=None))
    assert in_pieces(study, with_curve, stub(effects=added, current=stub(score=-2.1))) is pieces  # type: ignore[arg-type]


@pytest.mark.parametrize(("gain", "followed"), [(0.05, False), (0.2, True)])
def test_others_are_looked_for_beside_a_name_that_brings_a_part_of_what_the_curve_does(
    monkeypatch, stub, gain: float, followed: bool
) -> None:
    """Seen: half a minute of names beside one that took a twentieth of a curve's gain."""
    before, branch = stub(score=0.0), stub(took_one=True, current=stub(score=-gain))
    with_curve = stub(current=stub(score=-1.0), steps=(stub(parent=before, ranked=(), screened=()),))
    joined: list[bool] = []

    def taken(*_: object, **__: object) -> object:
        yield branch
        return branch

    def beside(*_: object, **__: object) -> object:
        joined.append(True)
        yield branch
        return branch

    monkeypatch.setattr(forward, "take_best", taken)
    monkeypatch.setattr(forward, "with_richer_form", taken)
    monkeypatch.setattr(forward, "take_effects", beside)
    study = stub(settings=DiagnosisSettings())
    assert result_of(_without_curves(study, stub(), with_curve)) is branch  # type: ignore[arg-type]
    assert bool(joined) is followed


@pytest.mark.parametrize(
    ("before", "complete", "again"),
    [("speed", True, True), ("speed", False, False), ("time", True, False), ("", True, False)],
)
def test_names_are_not_asked_once_more_where_the_same_curve_completes_the_model_again(
    monkeypatch, stub, before: str, complete: bool, again: bool
) -> None:
    """Seen: half a minute of names for a torque that fades with speed, whose curve the search with one experiment less had found."""

    def curve(signal: str) -> object:
        return stub(port="actuator", label="", mechanism=stub(name="unknown", signal=signal, factor="input"))

    monkeypatch.setattr(forward, "completes", lambda fitted, settings: complete)
    found = stub(effects=(curve(before),)) if before else None
    with_curve = stub(effects=(curve("speed"),), current=stub(), found_before=found)
    assert _stands_again(stub(settings=DiagnosisSettings()), with_curve) is again  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("gains", "within"), [((0.1,), True), ((0.9, 0.2), False), ((0.9, 0.9), True), ((0.9, 1.5, 0.1), False)]
)
def test_names_are_looked_for_as_long_as_they_may_come_as_far_as_the_curve(stub, gains, within: bool) -> None:
    """Each further one, of four at most, is taken to gain what the newest did; the first one says nothing. Seen: half a minute on an arm's
    third name, which had to gain 2.3 where the second gained 0.18."""
    before, reached = stub(score=0.0, effects=()), sum(gains)
    with_curve = stub(current=stub(score=-3.2), steps=(stub(parent=before),))
    steps = (stub(parent=stub(score=gains[-1] - reached)),)
    branch = stub(effects=gains, current=stub(score=-reached), steps=steps)
    study = stub(settings=DiagnosisSettings(), budget=SearchBudget(most_effects=4))
    assert within_reach(study, with_curve, branch) is within  # type: ignore[arg-type]


def test_of_names_that_are_pieces_of_a_curve_the_first_is_asked_where_the_curve_does_not_hold(stub) -> None:
    """Seen: a pendulum's dry friction, which held-out recordings bear out and which was lost beside a warm-up and a ripple."""
    start, branch = grown(stub, {"dry": -1.0, "warmup": -1.1})
    curve = stub(current=stub(score=-2.0))
    found = before_pieces(start, curve, branch)
    assert found is not None and found.current.effects == ("dry",) and found.steps == branch.steps[:2]
    assert before_pieces(start, curve, replace(start, steps=(*start.steps, stub(taken=None)))) is None
    assert before_pieces(start, curve, start) is None


def test_names_that_went_farther_than_the_curve_before_pieces_joined_them_are_asked_together(stub) -> None:
    """Seen: a stage's constant force and dry friction, with a ripple and a stop beside them: the constant force alone was told."""
    start, branch = grown(stub, {"bias": -0.5, "dry": -2.7, "ripple": -3.0, "stop": -3.5})
    found = before_pieces(start, stub(current=stub(score=-2.2)), branch)
    assert found is not None and found.current.effects == ("bias", "dry")
    found = before_pieces(start, stub(current=stub(score=-2.8)), branch)
    assert found is not None and found.current.effects == ("bias", "dry", "ripple")
    found = before_pieces(start, stub(current=stub(score=-3.4)), branch)
    assert found is not None and found.current.effects == ("bias",), "all of them are what is in pieces"


def grown(stub, scores: dict[str, float]) -> tuple[SearchState, SearchState]:
    """A search that began with a step that took nothing, and what it took one by one, with the scores reached."""
    names, started = tuple(scores), stub(taken=None)
    none = stub(effects=(), score=0.0)
    reached = [stub(effects=names[: k + 1], score=score) for k, score in enumerate(scores.values())]
    start = SearchState(none, none, steps=(started,))
    return start, SearchState(none, reached[-1], steps=(started, *(stub(taken=stub(fitted=one)) for one in reached)))


@pytest.mark.parametrize(
    ("taken", "beside", "gain", "named"),
    [(False, (), 0.2, True), (True, (), 0.2, False), (False, ("law",), 0.2, False), (False, (), 0.001, False)],
    ids=["nothing was sure", "something was taken", "of another hypothesis", "no gain"],
)
def test_a_name_that_few_windows_leave_open_is_asked_once_a_fine_curve_is_sure(
    monkeypatch, stub, taken, beside, gain, named
) -> None:
    """Seen: a bias of 3.5 times the floor, 2 standard errors from chance over 14 windows, told as unknown (0.97) by a curve of 40 bumps."""
    plain = stub(effects=())
    bias = stub(unknown=False, gain=gain, fitted=stub(effects=("bias",), problem=None))
    curve = stub(unknown=True, gain=0.25, fitted=stub(effects=("curve",)))
    step = SelectionStep((), stub(effects=beside), (curve, bias), bias if taken else None)
    with_curve = SearchState(plain, curve.fitted, (step, SelectionStep((), plain, (curve,), curve)))
    monkeypatch.setattr(forward, "chosen", lambda ranked, *_: next(iter(ranked), None))
    monkeypatch.setattr(forward, "least_gain", lambda *_: 0.01)
    start, study = SearchState(plain, plain), stub(settings=DiagnosisSettings())
    found = _name_before_fine_curve(study, start, with_curve)
    assert (found is not None) is named
    if found is not None:
        assert found.current is bias.fitted and found.steps[-1].taken is bias
        assert found.steps[-1].ranked == step.ranked
    alone = replace(with_curve, steps=with_curve.steps[-1:])
    assert _name_before_fine_curve(study, start, alone) is None
