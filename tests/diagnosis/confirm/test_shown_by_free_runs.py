"""What free runs show and windows hardly do is a finding."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.diagnosis import pipeline
from greybox_torch.diagnosis.confirm import shown_by_free_runs as module
from greybox_torch.diagnosis.confirm.shown_by_free_runs import shown_by_free_runs
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.schedule import Schedule
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, QuadraticDrag

FRICTION, BIAS = Attachment("motor", CoulombAsymmetry()), Attachment("arm", ConstantBias())
DRAG = Attachment("arm", QuadraticDrag())


@dataclass(frozen=True)
class FreeRuns:
    """What free runs of the validation experiments leave: times the noise without the effects, and the share of it with them."""

    times: float
    share: float
    unstable: frozenset[str] = frozenset()
    problem: Any = None
    begun: Any = None
    in_each: tuple[float, ...] = (0.1, 0.4)  # the share left in each experiment that judges

    @property
    def judges(self) -> set[str]:
        return {str(i) for i in range(len(self.in_each))}

    def mismatch(self, effects: bool, among: set[str]) -> float:
        return self.in_each[int(next(iter(among)))] if effects else 1.0

    def left(self, effects: bool) -> tuple[float, float, str]:
        return (self.share, 2.0, "sweep") if effects else (1.0, self.times, "sweep")


@pytest.fixture
def shown(monkeypatch):
    """What free runs show of two effects, with the standard errors by which held-out windows bear them out."""
    study: Any = SimpleNamespace(settings=DiagnosisSettings(), surroundings={"motor": None, "arm": None}, budget=None)
    state: Any = SimpleNamespace(effects=(FRICTION, BIAS), current=None)

    def ask(
        runs: FreeRuns,
        friction: float,
        bias: float,
        everywhere: bool = True,
        size: float = 0.12,
        drag: float | None = None,
    ) -> set[str]:
        state.effects = (FRICTION, BIAS) if drag is None else (DRAG,)
        monkeypatch.setattr(module, "constant_effect", lambda *_: everywhere)
        away = {FRICTION.prefix: friction, BIAS.prefix: bias, DRAG.prefix: drag}
        gains: Any = {n: SimpleNamespace(errors_away=a, size=size) for n, a in away.items()}
        return shown_by_free_runs(study, state, gains, runs)  # type: ignore[arg-type]

    return ask


def test_what_free_runs_need_and_windows_bear_out_is_shown(shown) -> None:
    """Seen: an arm's friction that differs by direction, 171 times the noise in free runs, 2.3 with it, 12 % of what windows leave."""
    assert shown(FreeRuns(171.0, 0.0001), 3.7, 0.4) == {FRICTION.prefix}
    assert shown(FreeRuns(171.0, 0.0001), 3.7, 5.0) == {FRICTION.prefix, BIAS.prefix}


@pytest.mark.parametrize(
    "runs",
    [
        FreeRuns(7.0, 0.01),
        FreeRuns(171.0, 0.3),
        FreeRuns(float("nan"), 0.01),
        FreeRuns(171.0, 0.01, frozenset({"sweep"})),
    ],
    ids=["as disturbances leave", "most of it left", "no noise known", "no free run follows"],
)
def test_not_what_disturbances_make_nor_what_free_runs_do_not_need(shown, runs) -> None:
    assert shown(runs, 3.7, 5.0) == set()


def test_a_law_that_follows_the_motion_is_no_disturbance(shown) -> None:
    """Seen: a drag, 5.4 times the noise in free runs and 1.1 with it; friction, 4.3 and 1.8, 2.8 standard errors by windows."""
    assert shown(FreeRuns(5.4, 0.01, in_each=(0.1, 0.7)), 0.0, 0.0, drag=4.2) == {DRAG.prefix}
    assert shown(FreeRuns(4.3, 0.14), 0.0, 0.0, everywhere=False, drag=2.8) == {DRAG.prefix}


@pytest.mark.parametrize(
    ("runs", "away"),
    [
        (FreeRuns(2.9, 0.01), 5.0),
        (FreeRuns(5.4, 0.3), 5.0),
        (FreeRuns(5.4, 0.1), 0.9),
        (FreeRuns(5.4, 0.1, in_each=(0.1, 0.6)), 2.8),
        (FreeRuns(5.4, 0.1, in_each=(0.1,)), 2.8),
    ],
    ids=["hardly more than noise", "much is left", "not by windows", "not in every experiment", "in a single one"],
)
def test_a_law_that_free_runs_do_not_need_in_each_experiment_has_to_be_beyond_chance(shown, runs, away) -> None:
    assert shown(runs, 0.0, 0.0, drag=away) == set()


def test_not_what_is_another_one_in_every_experiment_nor_chance(shown) -> None:
    assert shown(FreeRuns(171.0, 0.01), 3.7, 5.0, everywhere=False) == set()
    assert shown(FreeRuns(171.0, 0.01), 0.5, 0.5) == set()


def test_not_what_is_too_small_for_a_finding(shown) -> None:
    """Seen: an encoder's error, 1 % of the mismatch by free runs, told beside the drag that they show."""
    assert shown(FreeRuns(171.0, 0.01), 3.7, 5.0, size=0.01) == set()
    assert shown(FreeRuns(171.0, 0.01), 3.7, 5.0, size=float("nan")) == {FRICTION.prefix, BIAS.prefix}, "not known"


@pytest.mark.parametrize("small", [{FRICTION.prefix}, {FRICTION.prefix, BIAS.prefix}])
def test_asked_where_nothing_else_is_a_finding(monkeypatch, small) -> None:
    state = SimpleNamespace(effects=(FRICTION, BIAS), prefixes={FRICTION.prefix, BIAS.prefix})
    judged = SimpleNamespace(augmented=None, missed=None)
    found: Any = SimpleNamespace(
        by_parameters=None,
        study=None,
        state=state,
        judged=judged,
        gains={},
        others=None,
        complete=True,
        left=None,
        removed=0.5,
        schedule=Schedule(),
    )
    monkeypatch.setattr(pipeline, "sizes", lambda *_: {FRICTION.prefix: 0.12, BIAS.prefix: 0.12})
    told_of = [Effect("motor", name, 0.9, (), "", {}, 0.0, (), None) for name in ("friction", "bias")]
    monkeypatch.setattr(pipeline, "describe", lambda *_: told_of)
    monkeypatch.setattr(pipeline, "small_ones", lambda *_: dict.fromkeys(small, "why"))
    monkeypatch.setattr(pipeline, "shown_by_free_runs", lambda *_: {FRICTION.prefix})
    told = tuple(tuple(e.mechanism for e in part) for part in pipeline._told(found))
    assert told == ((("bias",), ("friction",)) if len(small) == 1 else (("friction",), ("bias",)))
