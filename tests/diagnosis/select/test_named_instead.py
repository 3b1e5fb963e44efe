"""How many names may stand for a free curve."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.select import forward
from greybox_torch.diagnosis.select.forward import _first_name, _in_pieces, _without_curves
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of


@pytest.mark.parametrize(
    ("ports", "pieces"),
    [(["pivot", "pivot"], False), (["pivot", "pivot", "arm"], False), (["pivot", "pivot", "pivot"], True)],
)
def test_more_than_two_names_at_the_place_of_a_curve_are_pieces_of_it(stub, ports, pieces) -> None:
    """Seen: a slack spring, outside the library, told as gravity, a stop, a bias and a ripple at the pivot."""
    before, added = stub(port="pivot"), [stub(port=port) for port in ports]
    taken = stub(candidate=stub(attachment=stub(port="pivot")))
    with_curve = stub(steps=(stub(parent=stub(effects=(before,)), taken=taken),))
    branch = stub(effects=(before, *added))
    assert _in_pieces(stub(settings=DiagnosisSettings()), with_curve, branch) is pieces  # type: ignore[arg-type]


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
    monkeypatch.setattr(forward, "take_effects", beside)
    study = stub(settings=DiagnosisSettings())
    assert result_of(_without_curves(study, stub(), with_curve)) is branch  # type: ignore[arg-type]
    assert bool(joined) is followed


def test_of_names_that_are_pieces_of_a_curve_the_first_is_asked_where_the_curve_does_not_hold(stub) -> None:
    """Seen: a pendulum's dry friction, which held-out recordings bear out and which was lost beside a warm-up and a ripple."""
    dry, none, two = (stub(effects=effects) for effects in (("dry",), (), ("dry", "warmup")))
    started, first, second, nothing = (
        stub(taken=None),
        stub(taken=stub(fitted=dry)),
        stub(taken=stub(fitted=two)),
        stub(taken=None),
    )
    start = SearchState(none, none, steps=(started,))
    found = _first_name(start, SearchState(none, two, steps=(started, first, second)))
    assert found is not None and found.current is dry and found.steps == (started, first)
    assert _first_name(start, SearchState(none, none, steps=(started, nothing))) is None
    assert _first_name(start, start) is None
