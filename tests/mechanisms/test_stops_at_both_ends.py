"""A body that goes from one end of its travel to the other meets a stop at both."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.surroundings import Surroundings

VALUES = {"k": 500.0, "low": -2.5, "high": 4.5, "c": 1.0}


def test_they_push_as_a_stop_at_either_end_does(law, anywhere) -> None:
    there = {"position": anywhere["position"], "speed": anywhere["speed"]}
    upper = law(EndStop(), {"k": 500.0, "c": 1.0, "where": 4.5, "side": 1.0}, **there)
    lower = law(EndStop(), {"k": 500.0, "c": 1.0, "where": -2.5, "side": -1.0}, **there)
    both = law(EndStop(True), VALUES, **there)
    np.testing.assert_allclose(both, upper + lower)
    assert both.min() < -1.0 and both.max() > 1.0


def test_both_have_to_be_met_and_neither_gives_way_far(around: Surroundings) -> None:
    stops, known = EndStop(True), {"k": 5.0, "low": 0.01, "high": 0.01, "c": 0.1}
    assert stops.degenerate(around, VALUES, known) is None
    assert stops.degenerate(around, VALUES, {**known, "k": 1000.0}) is None, "rigid: only that they are stiff is known"
    never_met = stops.degenerate(around, VALUES, {**known, "high": 0.5})
    assert never_met == "where the upper stop stands is not known: one of the two may not be there"
    assert "31 % of the travel lies beyond it" in str(stops.degenerate(around, {**VALUES, "low": -0.5}, known))
    assert "high = 5.9 lies outside" in str(stops.degenerate(around, {**VALUES, "high": 5.9}, known))


@pytest.mark.parametrize(("pushed", "both"), [((1.0, -1.0), True), ((0.0, -1.0), False), ((1.0, 0.0), False)])
def test_a_curve_that_pushes_back_at_both_ends_begins_as_stops_at_both(around, pushed, both) -> None:
    at = np.linspace(-3.0, 5.0, 81)
    force = pushed[0] * np.maximum(-2.5 - at, 0.0) + pushed[1] * np.maximum(at - 4.5, 0.0)
    form = EndStop().nearest(around, {"position": torch.tensor(at)}, force, np.ones(81))
    assert isinstance(form, EndStop) and form.both is both


def test_they_are_begun_stiffer_and_hard_at_both_ends_of_the_travel(around: Surroundings) -> None:
    further = list(EndStop(True).begun_elsewhere(around, {**VALUES, "k": 2.0}))
    assert further == [{"k": 60.0}, {"k": 2000.0, "low": -3.0, "high": 5.0}]
