"""What stands of a search that was stopped: what free runs leave at most half of the mismatch with."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.confirm import curve_instead, when_stopped
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings


def _steps(stub, plain: Any, *taken: tuple[Any, Any, bool]) -> tuple[Any, ...]:
    """The steps of a search from ``plain``: each effect that was taken, the hypothesis with it, and whether it is a curve."""
    parents = (plain, *(fitted for _, fitted, _ in taken))
    return tuple(
        SelectionStep((), parent, (), stub(fitted=fitted, unknown=unknown, gain=1.0, candidate=stub(attachment=effect)))
        for parent, (effect, fitted, unknown) in zip(parents, taken, strict=False)
    )


@pytest.mark.parametrize(
    ("left", "holds", "unknown", "stands"),
    [(0.1, True, False, True), (0.6, True, False, False), (0.1, False, False, False), (0.1, True, True, True)],
)
def test_where_time_ends_what_led_the_search_stands_if_free_runs_bear_it_out(
    monkeypatch, stub, left, holds, unknown, stands
) -> None:
    """Seen: 300 times the noise without a name, as four effects that came after the right statement were being taken back."""
    gain, ripple = stub(prefix="actuator.gain"), stub(prefix="motor.ripple")
    plain, alone, both = (stub(effects=e) for e in ((), (gain,), (gain, ripple)))
    steps = _steps(stub, plain, (gain, alone, unknown), (ripple, both, False))
    judged = stub(
        having=lambda final, *_: stub(holds=holds, mismatch=lambda effects: left if effects else 1.0),
        without_effects=lambda: None,
    )
    monkeypatch.setattr(when_stopped, "from_longest_windows", lambda hypothesis: hypothesis)
    monkeypatch.setattr(when_stopped, "sound", lambda study, ranked: True)
    study = stub(settings=DiagnosisSettings())
    state, gains, _, _, whole = when_stopped.found_first(study, SearchState(plain, both, steps), judged)
    assert state.current is (alone if stands else plain) and not gains and not whole
    assert when_stopped.found_first(study, SearchState(plain, plain), judged)[0].current is plain


@pytest.mark.parametrize(
    ("left_with_both", "unknown", "stands"), [(0.1, False, True), (0.7, False, False), (0.1, True, False)]
)
def test_of_two_effects_of_which_neither_is_half_of_the_mismatch_both_stand_where_time_ends(
    monkeypatch, stub, left_with_both, unknown, stands
) -> None:
    """Seen: friction over an arm's position (64 %) and its spring's play (35 %), both taken back as time ended."""
    friction, play, crumb = (stub(prefix=p) for p in ("motor.friction", "arm_spring.backlash", "arm.friction"))
    plain, alone, both, three = (stub(effects=e) for e in ((), (friction,), (friction, play), (friction, play, crumb)))
    left = {1: 0.6, 2: left_with_both, 3: 0.01}
    judged = stub(
        having=lambda final, *_: stub(
            holds=True, mismatch=lambda effects: left[len(final.effects)] if effects else 1.0
        ),
        without_effects=lambda: None,
    )
    monkeypatch.setattr(when_stopped, "from_longest_windows", lambda hypothesis: hypothesis)
    monkeypatch.setattr(when_stopped, "sound", lambda study, ranked: True)
    steps = _steps(stub, plain, (friction, alone, False), (play, both, unknown), (crumb, three, False))
    chosen_anew = stub(parent=stub(effects=(play, crumb)), taken=stub(candidate=stub(attachment=friction)))
    state = SearchState(plain, three, (*steps, chosen_anew))
    found = when_stopped.found_first(stub(settings=DiagnosisSettings()), state, judged)[0]
    assert found.current is (both if stands else plain)


@pytest.mark.parametrize(
    ("gain", "left_with_curve", "stands"), [(0.6, 0.2, True), (0.6, 0.7, False), (0.001, 0.2, False)]
)
def test_the_curve_of_the_first_step_stands_where_its_names_do_not(
    monkeypatch, stub, gain, left_with_curve, stands
) -> None:
    """Seen: a notch of a gear at 60 times the noise without a name, whose curve stood second behind a transmission error (1.08)."""
    error, curve = stub(prefix="gear_spring.transmission_error"), stub(prefix="gearbox.unknown")
    plain, named, drawn = (stub(effects=e) for e in ((), (error,), (curve,)))
    left = {error.prefix: 0.9, curve.prefix: left_with_curve}
    judged = stub(
        having=lambda final, *_: stub(
            holds=True, mismatch=lambda effects: left[final.effects[0].prefix] if effects else 1.0
        ),
        without_effects=lambda: None,
    )
    monkeypatch.setattr(when_stopped, "from_longest_windows", lambda hypothesis: hypothesis)
    for module in (when_stopped, curve_instead):
        monkeypatch.setattr(module, "sound", lambda study, ranked: True)
    by_name, by_curve = (
        stub(fitted=fitted, unknown=unknown, gain=gain, candidate=stub(attachment=effect))
        for fitted, unknown, effect in ((named, False, error), (drawn, True, curve))
    )
    searched = SearchState(plain, named, (SelectionStep((), plain, (by_name, by_curve), by_name),))
    found = when_stopped.found_first(stub(settings=DiagnosisSettings()), searched, judged)[0]
    assert found.current is (drawn if stands else plain)
    assert not stands or found.step_of(curve.prefix).taken is by_curve
