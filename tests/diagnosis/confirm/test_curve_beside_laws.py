"""The size of a free curve beside laws, by free runs of the validation experiments."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.confirm import curve_beside_laws as module
from greybox_torch.diagnosis.confirm.curve_beside_laws import sized_by_free_runs
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.settings import DiagnosisSettings


@pytest.fixture
def sized(monkeypatch, stub):
    """The size of a curve that was 0.62 by windows, where free runs leave ``without`` it and ``beside`` it of a mismatch of 1."""
    monkeypatch.setattr(module, "finish", lambda rest, *_: rest)
    study = stub(settings=DiagnosisSettings(), budget=None, recorded=None, working_on=lambda text: None)

    def runs(left: float, unstable: frozenset[str] = frozenset()) -> Any:
        return stub(
            judges={"sweep", "steps"},
            unstable=unstable,
            mismatch=lambda effects, among: len(among) * (left if effects else 1.0),
        )

    def ask(without: float, beside: float = 0.01, unstable: frozenset[str] = frozenset()) -> float:
        curve = stub(prefix="sensor.unknown", mechanism=stub(free=True))
        drag = stub(prefix="pivot.drag", mechanism=stub(free=False))
        state = stub(effects=(curve, drag), without={"sensor.unknown": "the drag alone"})
        judged = runs(beside)
        judged.having = lambda final, places: runs(without, unstable)
        gains = {"sensor.unknown": Gain(0.5, 0.05, size=0.62), "pivot.drag": Gain(0.3, 0.05, size=0.3)}
        others = stub(places=lambda hypothesis: {})
        found = sized_by_free_runs(study, state, others, gains, judged)
        assert found["pivot.drag"] == gains["pivot.drag"]
        return found["sensor.unknown"].size

    return ask


def test_what_is_large_over_windows_alone_is_small(sized) -> None:
    """Seen: an encoder 2 mrad out, told at the sensor (0.97) beside the drag that a pendulum's model lacked."""
    assert sized(without=0.02) == pytest.approx(0.01)
    assert sized(without=0.005) == 0.0, "free runs are better without it"


def test_what_free_runs_need_keeps_the_size_of_windows(sized) -> None:
    assert sized(without=0.9) == 0.62


def test_one_that_no_free_run_judges_keeps_it_too(sized) -> None:
    assert sized(without=0.02, unstable=frozenset({"sweep", "steps"})) == 0.62


def test_without_laws_or_held_out_experiments_there_is_nothing_to_ask(stub) -> None:
    curve = stub(prefix="sensor.unknown", mechanism=stub(free=True))
    gains = {"sensor.unknown": Gain(0.5, 0.05, size=0.62)}
    alone = stub(effects=(curve,), without={"sensor.unknown": None})
    both = stub(effects=(curve, curve), without={"sensor.unknown": None})
    study: Any = stub()
    assert sized_by_free_runs(study, alone, stub(), gains, stub()) is gains
    assert sized_by_free_runs(study, both, None, gains, stub()) is gains
