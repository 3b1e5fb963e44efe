"""Effects that account for less of the mismatch than is left with all of them are no findings where the fit hardly rises."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.diagnosis.confirm import less_than_is_left as module
from greybox_torch.diagnosis.confirm.less_than_is_left import less_than_is_left
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()
SIZES = {"nut.end_stop": 0.19, "strut.stiffness": 0.6}


def asked(
    monkeypatch, share: float, times: float, points: float, *, windows: bool = False, effects: bool = True
) -> set[str]:
    monkeypatch.setattr(module, "points_gained", lambda judged: points)
    judged: Any = SimpleNamespace(by_windows_alone=windows, left=lambda effects: (share, times, "sweep"))
    state: Any = SimpleNamespace(effects=tuple(SIZES) if effects else (), prefixes=set(SIZES))
    return set(less_than_is_left(state, SIZES, judged, SETTINGS))


def test_less_than_free_runs_leave_is_a_part_of_it(monkeypatch) -> None:
    """Seen: eleven small laws of a complete strut, told as an end stop (0.97), 19 % of the mismatch, of which 53 % was left."""
    assert asked(monkeypatch, 0.53, 3.1, 0.6) == {"nut.end_stop"}
    assert asked(monkeypatch, 0.82, 5.0, 0.3) == set(SIZES)


@pytest.mark.parametrize(
    ("share", "times", "points"),
    [(0.1, 20.0, 0.6), (0.53, 2.0, 0.6), (0.53, float("nan"), 0.6), (0.79, 22.0, 6.8)],
    ids=["little is left", "hardly more than noise", "nothing shows the noise", "the fit rises"],
)
def test_else_it_stands(monkeypatch, share, times, points) -> None:
    assert asked(monkeypatch, share, times, points) == set()


def test_only_free_runs_and_effects_are_asked(monkeypatch) -> None:
    assert asked(monkeypatch, 0.53, 3.1, 0.6, windows=True) == set()
    assert asked(monkeypatch, 0.53, 3.1, 0.6, effects=False) == set()


@pytest.mark.parametrize(
    ("size", "share", "times", "small"),
    [
        (0.033, 0.028, 23.5, True),
        (0.066, 0.054, 5.7, True),
        (0.034, 0.002, 7.3, False),
        (0.024, 0.037, 2.8, True),
        (0.033, 0.028, 1.2, False),
        (0.025, 0.007, 1.8, False),
        (0.12, 0.1, 23.5, False),
    ],
    ids=[
        "a mount's hysteresis",
        "a roller's mode",
        "little is left",
        "a chassis' mode",
        "noise",
        "more than is left",
        "not little",
    ],
)
def test_little_beside_a_larger_one_is_more_than_what_is_left(monkeypatch, size, share, times, small) -> None:
    """Seen: a rubber mount's hysteresis (0.85) beside a centrifuge's drag, 3.3 %, where 2.8 % was left; the fit rose by 7.7 points."""
    monkeypatch.setitem(SIZES, "nut.end_stop", size)
    assert asked(monkeypatch, share, times, 7.7) == ({"nut.end_stop"} if small else set())


def test_the_largest_effect_is_none_of_what_it_lacks_itself(monkeypatch) -> None:
    monkeypatch.setitem(SIZES, "nut.end_stop", 0.05)
    monkeypatch.setitem(SIZES, "strut.stiffness", 0.05)
    assert asked(monkeypatch, 0.9, 20.0, 7.7) == set()
