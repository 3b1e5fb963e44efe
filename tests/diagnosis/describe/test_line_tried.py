"""A heat loss that grows with the wind, as a curve of which some bumps were left out: straight lines, shared parameters, deviations."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest

from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis.curve import Curve
from greybox_torch.diagnosis.describe import line_tried as module
from greybox_torch.diagnosis.describe.effects import describe
from greybox_torch.diagnosis.describe.line_tried import line_tried
from greybox_torch.diagnosis.describe.profiles import law_curve
from greybox_torch.diagnosis.describe.shared_with_parameters import _where_zero, shared_with_parameters
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.select.all_that_is_left import LeftInFreeRuns
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, GreyBoxModel, Input, Output, Parameter, State

from ..conftest import found

STEP, SAMPLES = 60.0, 1500


class Room(GreyBoxModel):
    """C dT/dt = heating - U (T - outside); of the wind it knows nothing."""

    states = [State("air", "degC")]
    inputs = [Input("heating", "W"), Input("outside", "degC"), Input("wind", "m/s")]
    outputs = [Output("air", "degC")]
    parameters = [Parameter("C", 2e5, unit="J/K", lower=1e3), Parameter("U", 150.0, unit="W/K", lower=0.0)]
    ports = [Balance("air", level="air")]

    def derivative(self, x, u, p, port):
        return {"air": (u.heating - p.U * (x.air - u.outside) + port.air) / p.C}

    def output(self, x, u, p):
        return {"air": x.air}


def recorded(data_set, loss):
    """An experiment of a room with C = 2e5 J/K that loses ``loss`` of the wind W/K."""
    rng, air = np.random.default_rng(5), [20.0]
    heating = np.repeat(rng.uniform(0.0, 4000.0, SAMPLES // 30), 30)
    wind = np.repeat(rng.uniform(0.0, 8.0, SAMPLES // 20), 20)
    outside = np.full(SAMPLES, 5.0) + np.repeat(rng.uniform(-2.0, 2.0, SAMPLES // 50), 50)
    for now, out, blows in zip(heating[:-1], outside, wind, strict=False):
        settled = out + now / loss(blows)
        air.append(settled + (air[-1] - settled) * np.exp(-STEP * loss(blows) / 2e5))
    measured = np.array(air) + rng.normal(0.0, 0.05, SAMPLES)
    channels = {"heating": "W", "outside": "degC", "wind": "m/s", "air": "degC"}
    experiment = {"heating": heating, "outside": outside, "wind": wind, "air": measured}
    return data_set(channels, [experiment], roles=["estimation"], sample_time=STEP)


@pytest.fixture(scope="module")
def told(data_set, begun):
    """The fit of whole records with a curve over the wind of which some bumps were left out, what tries a line, and what is shared."""

    def of(loss):
        search = begun(recorded(data_set, loss), Room())
        law = Unknown("input@wind", 8, factor="above@outside", left_out=(0, 3, 4, 7))
        effect = attach(search.problem.model, "air", law)
        fitted = search.refitted([effect], search.plain)
        final = finish(fitted)
        curve = law_curve(fitted.model, effect, search.surroundings["air"], final.problem)
        shared = shared_with_parameters(fitted, effect, final.problem, curve)
        return final, partial(line_tried, search.study, fitted, attachment=effect, site=Room.ports[0]), shared

    return cache(of)


def straight(wind):
    return 100.0 + 20.0 * wind


def bent(wind):
    return 100.0 + 150.0 * (wind > 4.0)


def test_a_loss_by_the_wind_is_a_straight_line(told) -> None:
    """Seen: a curve with steps for -140 * wind, U = 1757.3 ± 2.6 W/K beside it for 1250, and not a word of either."""
    final, tried, shared = told(straight)
    line = tried(final=final)
    assert line is not None
    head, _, rest = line.equation.partition(" += ")
    slope, *others = rest.split(" * ")
    assert (head, others) == ("port.air", ["wind", "(air - outside)"])
    assert float(slope) == pytest.approx(-20.0, rel=0.03)
    assert "a straight line in the place of the curve, with U = " in line.told
    assert shared.startswith("the model's U does what such a curve can do as well")
    value, deviation = final.values()["U"], final.told.deviations()["U"]
    assert abs(value - 100.0) < 3.0 * deviation, "that bumps were left out is no knowledge"


def test_a_bent_curve_is_none_and_no_line_is_fitted_in_its_place(told, monkeypatch) -> None:
    final, tried, shared = told(bent)
    monkeypatch.setattr(module, "CLEARLY_BENT", np.inf)
    assert tried(final=final) is None
    monkeypatch.undo()
    monkeypatch.setattr(module, "_along", lambda *_: pytest.fail("a descent"))
    assert tried(final=final) is None
    assert shared.startswith("the model's U does what such a curve can do as well"), (
        "a constant of it, however bent it is"
    )


@pytest.mark.parametrize("how", ["weighed", "of_windows"])
def test_a_line_is_compared_where_the_least_squared_error_of_whole_records_was_fitted(told, how: str) -> None:
    final, tried, _ = told(straight)
    assert tried(final=replace(final, **{how: True})) is None


@pytest.mark.parametrize("seconds", [None, 0.0])
def test_a_line_is_told_where_there_is_time_to_try_it(data_set, begun, seconds: float | None) -> None:
    search = begun(recorded(data_set, straight), Room())
    law = Unknown("input@wind", 8, factor="above@outside", left_out=(0, 3, 4, 7))
    effect = attach(search.problem.model, "air", law)
    state = found(search, effect, {})
    said = (LeftInFreeRuns(0.001), {}, {effect.prefix: 0.9}, 0.9)
    (one,) = describe(search.study, state, finish(state.current), *said, Deadline.after(seconds))
    assert bool(one.equation) is (seconds is None) and bool(one.of_line) is (seconds is None)


@pytest.mark.parametrize(
    ("force", "told"),
    [
        ([2.0, 1.0, -1.0], ", which is zero at wind = 1.5 m/s"),
        ([1.0, 0.0, -1.0], ", which is zero at wind = 1 m/s"),
        ([0.0, 1.0, 2.0], ", which is zero at wind = 0 m/s"),
        ([1.0, -1.0, 1.0], ""),
        ([0.0, -1.0, 1.0], ""),
        ([0.0, 0.0, 1.0], ""),
        ([1.0, 2.0, 3.0], ""),
    ],
)
def test_where_the_curve_is_zero_is_told_if_it_is_so_once(force: list[float], told: str) -> None:
    assert _where_zero(Curve("wind", "m/s", np.arange(3.0), np.array(force), "W")) == told
