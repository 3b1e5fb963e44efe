"""Free curves in the place of several names at once, each of which is a rough form of what the library does not have."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.diagnosis.confirm.curves_for_names import curves_for_names
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.balance import LinearLeak
from greybox_torch.mechanisms.unknown import Unknown
from tests.diagnosis.by_runge_kutta import by_runge_kutta

STEP = 4.0


class Plate(GreyBoxModel):
    """Two zones of a hot plate, a heater under the first; convection to the room."""

    states = [State(n, "degC", initial="measured") for n in ("T1", "T2")]
    inputs = [Input("power", "W"), Input("second", "W")]
    outputs = [Output(n, "degC") for n in ("T1", "T2")]
    parameters = [
        Parameter("C", 400.0, unit="J/K", lower=1.0),
        Parameter("G", 2.0, unit="W/K", lower=0.0),
        Parameter("h", 0.7, unit="W/K", lower=0.0),
        Parameter("room", 22.0, unit="degC", fixed=True),
    ]
    ports = [Balance("zone1", level="T1"), Balance("zone2", level="T2")]

    def derivative(self, x, u, p, port):
        across = p.G * (x.T1 - x.T2)
        return {
            "T1": (u.power - across - p.h * (x.T1 - p.room) + port.zone1) / p.C,
            "T2": (u.second + across - p.h * (x.T2 - p.room) + port.zone2) / p.C,
        }

    def output(self, x, u, p):
        return {"T1": x.T1, "T2": x.T2}


def radiating(data_set):
    """Both zones radiate, which the model leaves out."""
    rng, runs = np.random.default_rng(4), []

    def rate(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        lost = 0.5 * (x - 22.0) + 1.4e-9 * ((x + 273.15) ** 4 - 295.15**4)
        across = 3.0 * (x[0] - x[1])
        return (u + np.array([-across, across]) - lost) / 420.0

    for _ in range(3):
        held = rng.choice([0.0, 60.0, 150.0, 300.0], (30, 2)).repeat(50, axis=0)
        states = by_runge_kutta(rate, np.array([22.0, 22.0]), held, STEP, 2)
        noisy = states + rng.normal(0, 0.03, states.shape)
        runs.append({"power": held[:, 0], "second": held[:, 1], "T1": noisy[:, 0], "T2": noisy[:, 1]})
    units = {"power": "W", "second": "W", "T1": "degC", "T2": "degC"}
    return data_set(units, runs, sample_time=STEP, hold="zoh", roles=["estimation", "estimation", "validation"])


@pytest.fixture(scope="module")
def told(data_set, begun):
    """The plate with a leak at either zone in the place of what radiates there, each of which a curve outdid beside the other."""
    search = begun(radiating(data_set), Plate())
    leaks = [attach(search.problem.model, zone, LinearLeak()) for zone in ("zone1", "zone2")]
    fitted = search.refitted(leaks, search.plain, [{f"{k.prefix}.c": 0.2 for k in leaks}])
    return search, search.at(fitted, steps=tuple(outdone(search, leak, fitted) for leak in leaks)).state


def outdone(search, law, fitted, further: float = 0.3, port: str = "") -> SelectionStep:
    """A step that took a law, where a curve gained more."""
    curve = attach(search.problem.model, port or law.port, Unknown("level", 8))
    ranked = [
        RankedCandidate(Candidate(a, (), 0.9), fitted, gain, 9.0) for a, gain in ((curve, 1 + further), (law, 1.0))
    ]
    return SelectionStep((), search.plain, tuple(ranked), ranked[1])


def free_runs(stub, share: float = 0.04, times: float = 6.4):
    return stub(left=lambda effects: (share, times, "run 3"))


def test_what_radiates_at_several_zones_is_a_curve_at_each(told, stub) -> None:
    """Seen: "threshold flow at zone 2, leaks at zones 1 and 3 to rooms at 80 degC", 0.97 each, where the room was at 22 degC."""
    search, state = told
    drawn = curves_for_names(search.study, state, free_runs(stub))
    assert drawn is not None
    assert {(e.port, e.mechanism.name) for e in drawn.effects} == {("zone1", "unknown"), ("zone2", "unknown")}
    assert times_noise(search.problem, state.current, search.study.settings) > 3.0
    assert times_noise(search.problem, drawn.current, search.study.settings) < 1.1
    assert drawn.current.values()["G"] == pytest.approx(3.0, rel=5e-3)
    assert drawn.named is state and drawn.compared_without


def test_only_where_much_is_left_and_curves_outdo_names_at_several_ports(told, stub) -> None:
    search, state = told
    first, (leak, other) = state.steps[0], state.effects
    asked = partial(curves_for_names, search.study)
    assert asked(state, free_runs(stub, share=0.01)) is None
    assert asked(state, free_runs(stub, times=2.0)) is None
    near = outdone(search, other, state.current, further=0.05)
    assert asked(replace(state, steps=(first, near)), free_runs(stub)) is None, "a curve that goes hardly farther"
    away = outdone(search, other, state.current, port="zone1")
    assert asked(replace(state, steps=(first, away)), free_runs(stub)) is None, "a curve somewhere else"
    alone = replace(state, current=search.refitted([leak], state.current), steps=(first,))
    assert asked(alone, free_runs(stub)) is None, "one name has been asked in its own step"
