"""An unknown that remembers in the place of nothing, where free runs and held-out windows bear it out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.confirm import far_better
from greybox_torch.diagnosis.confirm import memory_instead as module
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.memory_instead import memory_instead
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings

SURE, CHANCE = Gain(0.9, 0.1, size=0.9), Gain(0.9, 0.5, size=0.9)


@pytest.fixture
def world(monkeypatch, stub):
    """A search that came to a curve, what a residual with memory leaves of the mismatch, and how many times the noise free runs leave."""
    plain, curve = stub(effects=()), stub(effects=(stub(prefix="inlet.unknown"),))
    with_memory = stub(effects=(stub(prefix="moisture.unknown_with_memory"),))
    asked: list[SearchState] = []

    def ask(left=0.1, held_out=SURE, times=11.0, took=True, searched=None, held=True):
        by_it = stub(mismatch=lambda effects: left if effects else 1.0, holds=True, unstable=())

        def residual(study, state, standing):
            asked.append(state)
            step = stub(taken=stub() if took else None)
            return replace(state.at(with_memory if took else plain), steps=(step,))

        monkeypatch.setattr(module, "linear_residual", residual)
        monkeypatch.setattr(far_better, "free_runs_of", lambda *asked: by_it)
        monkeypatch.setattr(
            far_better, "held_out_gains", lambda state, others: {"moisture.unknown_with_memory": held_out}
        )
        study = stub(settings=DiagnosisSettings(), working_on=lambda text: None)
        state = SearchState(plain, curve) if searched is None else searched(plain, curve)
        return memory_instead(study, state, stub() if held else None, stub(left=lambda effects: (1.0, times, "e2")))

    return ask, asked, plain, with_memory


def test_what_held_out_experiments_bear_out_stands(world) -> None:
    ask, asked, plain, with_memory = world
    found = ask()
    assert found is not None and asked[0].effects == () and asked[0].current is plain
    state, gains, judged = found
    assert state.current is with_memory and judged.holds and gains == {"moisture.unknown_with_memory": SURE}
    assert state.without == {"moisture.unknown_with_memory": plain} and state.memory is not None


@pytest.mark.parametrize(
    "case",
    [{"left": 0.6}, {"held_out": CHANCE}, {"took": False}],
    ids=["too much is left", "chance", "none comes near"],
)
def test_else_nothing_stands(world, case) -> None:
    ask, asked, *_ = world
    assert ask(**case) is None and len(asked) == 1


@pytest.mark.parametrize(
    "case",
    [
        {"times": 2.0},
        {"held": False},
        {"searched": lambda plain, curve: SearchState(plain, plain)},
        {"searched": lambda plain, curve: SearchState(plain, curve, memory=SearchState(plain, plain))},
    ],
    ids=["little is left", "nothing is held out", "nothing was found", "asked before"],
)
def test_where_there_is_nothing_to_ask_it_is_not_asked(world, case) -> None:
    ask, asked, *_ = world
    assert ask(**case) is None and not asked
