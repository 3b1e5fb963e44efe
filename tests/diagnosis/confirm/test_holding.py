"""Which effects stand once they were fitted to whole records."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.deadline import TimeIsUp
from greybox_torch.diagnosis.confirm import holding
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.holding import WINDOWS_STAND, _empty
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.stribeck import StribeckFriction


@pytest.fixture(autouse=True)
def shares(monkeypatch: pytest.MonkeyPatch) -> dict[str, float]:
    """What the other parameters leave of an effect, by prefix."""
    left: dict[str, float] = {}
    for asked in ("_drifting", "_within_disturbances"):
        monkeypatch.setattr(holding, asked, lambda study, state, judged: None)
    monkeypatch.setattr(holding, "not_undone", lambda fitted, effect, surroundings: left.get(effect.prefix, 1.0))
    monkeypatch.setattr(
        holding, "sizes", lambda study, state, gains: {p: g.size for p, g in gains.items()} or {"link.law": 0.1}
    )
    return left


def a_stop(stub: Any, found: Gain | None, law: Any = EndStop, over_windows: float = 0.5) -> Any:
    """What is known of a hard stop whose stiffness and damping trade for one another; both ``over_windows``, and 0.5 over whole records."""
    around = Surroundings({"position": Range(-1.0, 1.0, 0.5), "speed": Range(-2.0, 2.0, 1.0)}, {}, "N m", 1e-3)
    effect = stub(prefix="link.law", port="link", mechanism=law(), own=lambda values: Attachment.own(effect, values))
    values = {p.name: p.value if p.fixed else 0.5 for p in law().parameters(around)}
    named = {f"link.law.{n}": v for n, v in values.items()}
    deviations = dict.fromkeys(named, 50.0)
    final = stub(
        values=lambda: named, deviations=lambda: deviations, uncertainty=None, problem=stub(free_names=tuple(named))
    )
    current = stub(values=lambda: dict.fromkeys(named, over_windows))
    study = stub(surroundings={"link": around}, settings=DiagnosisSettings())
    state, gains = stub(effects=(effect,), current=current), {} if found is None else {"link.law": found}
    return _empty(study, state, final, gains) or holding._undone(study, state, gains)


def test_what_held_out_experiments_prove_is_not_empty_whatever_trades_for_what(stub) -> None:
    """Seen: a stop that removed 99.9 % of the error on three held-out experiments was taken back, as its stiffness was 93 ± 3700."""
    assert a_stop(stub, Gain(0.999, 0.0005, size=0.999)) is None
    assert a_stop(stub, None) == "link.law"
    assert a_stop(stub, Gain(0.01, 0.02, size=0.01)) == "link.law"


@pytest.mark.parametrize(("left", "empty"), [(4e-5, True), (0.0075, False)])
def test_what_the_other_parameters_undo_is_empty_however_much_it_gains(stub, shares, left: float, empty: bool) -> None:
    """Seen: a sensor of a valve's travel that showed a third of it, beside a spring three times as stiff; what was missing was friction."""
    shares["link.law"] = left
    assert a_stop(stub, Gain(0.7, 0.01, size=0.16)) == ("link.law" if empty else None)
    assert a_stop(stub, Gain(0.999, 0.0005, size=0.999)) is None, "most of the mismatch: a leak, or what looks like it"


@pytest.mark.parametrize("over_windows", [5.5, -50.0])
def test_what_whole_records_leave_nothing_of_is_not_proven_by_windows(stub, over_windows: float) -> None:
    """Seen: a lag of 0.0013 ± 4 s, sampled every second, that had removed 6 % of the error over windows and changed no free run."""
    assert a_stop(stub, Gain(0.999, 0.0005, size=0.999), over_windows=over_windows) == "link.law"


@pytest.mark.parametrize("law", [StribeckFriction, AdditionalMode])
def test_a_law_without_what_makes_it_that_law_is_empty_however_much_it_gains(stub, law: Any) -> None:
    """Seen: a mode of 0.18 ± 21 N m s²/rad, 35 000 times the rotor that it hung on, which stood for a speed controller."""
    assert a_stop(stub, Gain(0.999, 0.0005, size=0.999), law) == "link.law"


@pytest.mark.parametrize("windows_hold", [True, False])
def test_where_whole_records_lead_astray_the_values_of_the_windows_may_stand(monkeypatch, stub, windows_hold) -> None:
    """Seen: a ripple of order 10 along a position that nobody measures; whole records drifted to 10.1, worse on validation."""
    effect = stub(prefix="rotor.ripple")
    state = stub(effects=(effect,), current="windows", compared_without=True)
    by_windows = stub(better_than=lambda other: windows_hold, augmented="windows", by_windows_alone=False)
    judged = stub(
        by_windows_alone=False,
        holds=False,
        augmented="records",
        having=lambda final, places: by_windows,
        without_effects=lambda: "plain",
    )
    monkeypatch.setattr(holding, "as_windows_have_it", lambda hypothesis, settings, records: hypothesis)
    monkeypatch.setattr(holding, "_empty", lambda *args: None)
    monkeypatch.setattr(holding, "_undone", lambda *args: None)
    monkeypatch.setattr(holding, "take_back_weakest", lambda *args: stub(effects=()))
    monkeypatch.setattr(holding, "said_of_windows", lambda *args: ())
    left, gains, kept, told, whole = holding.holding(stub(settings=None, recorded=None), state, None, {}, judged)
    assert whole
    if windows_hold:
        assert (left, kept, told) == (state, by_windows, (WINDOWS_STAND,))
    else:
        assert (left.effects, kept, told) == ((), "plain", ())


@pytest.mark.parametrize(("windows", "time"), [(True, True), (False, True), (False, False)])
def test_values_that_hold_on_some_experiments_give_way_to_better_ones_and_are_not_lost(
    monkeypatch, stub, windows, time
) -> None:
    """Where time is up while the values of the windows are tried, those of whole records stand."""
    state = stub(effects=(stub(prefix="rotor.ripple"),), current="windows", compared_without=True)
    by_windows = stub(better_than=lambda other: windows, augmented="windows", by_windows_alone=False)

    def having(final: Any, places: Any) -> Any:
        if not time:
            raise TimeIsUp
        return by_windows

    judged = stub(holds=True, unstable={"run 2"}, augmented="records", having=having, by_windows_alone=False)
    monkeypatch.setattr(holding, "as_windows_have_it", lambda hypothesis, settings, records: hypothesis)
    monkeypatch.setattr(holding, "_empty", lambda *args: None)
    monkeypatch.setattr(holding, "_undone", lambda *args: None)
    left, gains, kept, told, whole = holding.holding(stub(settings=None, recorded=None), state, None, {}, judged)
    assert left is state and whole is time
    assert (kept, told) == ((by_windows, (WINDOWS_STAND,)) if windows else (judged, ()))


def test_an_offset_that_drifts_is_taken_back_though_everything_else_holds(monkeypatch, stub) -> None:
    effect = stub(prefix="arm.constant_bias")
    state = stub(effects=(effect,), current="windows", compared_without=True, prefixes={"arm.constant_bias"})
    judged = stub(holds=True, unstable=(), augmented="records", by_windows_alone=False, without_effects=lambda: "plain")
    monkeypatch.setattr(holding, "_empty", lambda *args: None)
    monkeypatch.setattr(holding, "_undone", lambda *args: None)
    monkeypatch.setattr(holding, "_drifting", lambda *args: "arm.constant_bias")
    monkeypatch.setattr(holding, "_without", lambda *args: stub(effects=()))
    left, gains, kept, told, whole = holding.holding(stub(settings=None, recorded=None), state, None, {}, judged)
    assert (left.effects, gains, kept, told, whole) == ((), {}, "plain", (), True)


@pytest.mark.parametrize(("before", "after", "kept"), [(1e-4, 0.2, True), (1e-4, 0.01, False), (0.1, 0.5, False)])
def test_what_free_runs_need_is_no_less_there_for_being_undone_over_short_windows(
    monkeypatch, stub, before: float, after: float, kept: bool
) -> None:
    """Seen: a crane's boom, whose bias was taken back as undone, and with it its presliding. A model that leaves more anyway may lack
    something else, for which the effect stands."""

    def judgement(left: float) -> Any:
        return stub(
            left=lambda effects: (left, 9.0, "run 2"), holds=True, unstable=(), augmented=None, by_windows_alone=False
        )

    bias, slip = stub(prefix="boom.constant_bias"), stub(prefix="boom.presliding")
    both = stub(effects=(bias, slip), compared_without=True, prefixes={bias.prefix, slip.prefix})
    fewer = stub(effects=(slip,), compared_without=True, prefixes={slip.prefix})
    first, then = judgement(before), judgement(after)
    asked = {
        "_empty": lambda *args: None,
        "_undone": lambda study, state, gains, needed: bias.prefix if state is both and not needed else None,
        "_without": lambda study, state, prefix: fewer,
        "judged_anew": lambda *args: ("gains", then),
        "far_better": lambda *args: None,
    }
    for name, step in asked.items():
        monkeypatch.setattr(holding, name, step)
    left, _, judged, _, _ = holding.holding(stub(settings=DiagnosisSettings()), both, None, {}, first)
    assert (left, judged) == ((both, first) if kept else (fewer, then))


@pytest.mark.parametrize("against", [None, "_drifting", "_within_disturbances"])
def test_laws_that_were_passed_over_stand_where_nothing_speaks_against_one(monkeypatch, stub, against) -> None:
    """As of any other law: an offset beside which hardly more than noise is left is a slow disturbance."""
    by_it = stub(holds=True, unstable=(), augmented="records", by_windows_alone=False)
    found = (stub(effects=(stub(prefix="tank.constant_bias"),)), {}, by_it)
    monkeypatch.setattr(holding, "refitted_laws", lambda *args: found)
    monkeypatch.setattr(holding, "_empty", lambda *args: None)
    monkeypatch.setattr(holding, "_undone", lambda *args: None)
    if against is not None:
        monkeypatch.setattr(holding, against, lambda *args: "tank.constant_bias")
    assert holding.passed_over(stub(), stub(), None, stub()) is (found if against is None else None)
