"""Sub-steps are judged on the samples that experiments have: a run goes on beyond the end of a shorter one."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.substeps import choose_substeps, fine_enough
from greybox_torch.simulation.windows import whole_records

STEP, RATE, SHORT = 0.05, 8.0, 14


class Growth(GreyBoxModel):
    """What grows for a moment and is far beyond any float long after: x' = rate x³."""

    states = [State("level", "m")]
    inputs = [Input("flow", "m/s")]
    outputs = [Output("level", "m")]
    parameters = [Parameter("rate", RATE, unit="1/(m^2 s)", lower=0.0)]

    def derivative(self, x, u, p, port):
        return {"level": p.rate * x.level**3 + u.flow}

    def output(self, x, u, p):
        return {"level": x.level}


def records(*lengths: int) -> Records:
    last = np.cumsum(lengths) - 1
    first = last - np.array(lengths) + 1
    total = int(last[-1]) + 1
    names = tuple(f"e{k}" for k in range(len(lengths)))
    return Records(
        np.zeros((1, total)), np.linspace(0.3, 0.8, total)[None], np.full(total, STEP), first, last, names, "zoh"
    )


@pytest.mark.parametrize("longest", [SHORT, 200, 5000, 20000])
def test_a_longer_experiment_beside_leaves_the_sub_steps_of_a_short_one_as_accurate(longest: int) -> None:
    """From 0.3 m the level is infinite after 0.69 s, a moment beyond the short record; from 0 it stays there."""
    beside, stepper, p = records(SHORT, longest), make_stepper(Growth(), ()), np.array([RATE])
    start = 0.3
    starts = np.array([[start], [0.0]])
    chosen = choose_substeps(beside, stepper, p, starts, tolerance=1e-3)
    assert chosen is not None
    time = STEP * np.arange(SHORT)
    exact = start / np.sqrt(1 - 2 * RATE * start**2 * time)
    y = stepper.run(beside, Pass(whole_records(beside), p, starts), chosen).y[0, :SHORT, 0]
    assert np.sqrt(np.mean((y - exact) ** 2)) < 0.02


def test_what_comes_after_the_end_of_an_experiment_says_nothing() -> None:
    y, lengths = np.zeros((2, 6, 1)), np.array([3, 6])
    there, beyond = y.copy(), y.copy()
    there[0, 2], beyond[0, 3] = 0.3, np.inf
    limit = np.array([0.09])
    assert fine_enough(y, beyond, limit, lengths)
    assert not fine_enough(y, there, limit, lengths)
    assert fine_enough(y, there, np.array([0.11]), lengths)  # 0.3 in one of nine samples: 0.1 rms
    there[0, 2] = np.inf
    assert not fine_enough(y, there, limit, lengths)
