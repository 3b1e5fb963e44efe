"""Estimated start states that are not where the sensor is are told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate.far_starts import far_starts, told_far
from greybox_torch.estimate.problem import Problem, make_problem

NOISE = 0.08


class Plate(gt.GreyBoxModel):
    """Two zones, of which one is measured."""

    states = (gt.State("T", "degC", initial="measured"), gt.State("inner", "degC"))
    inputs = (gt.Input("P", "W"),)
    outputs = (gt.Output("T", "degC"),)
    parameters = (gt.Parameter("C", 100.0, unit="J/K"),)

    def derivative(self, x, u, p, port):
        return {"T": (u.P - x.T + x.inner) / p.C, "inner": (x.T - x.inner) / p.C}

    def output(self, x, u, p):
        return {"T": x.T}


def begun(start: float, *, counts: float = 0.0, inner: float = 0.0, missing: int = 0) -> Problem:
    """A problem with other start states than the first sample of a noisy sensor, or of one that counts."""
    time = np.arange(400.0)
    values = 22.0 + 20.0 * (1.0 - np.exp(-time / 100.0))
    values[1:] += NOISE * np.random.default_rng(0).standard_normal(399)
    if counts:
        values = counts * np.round(values / counts)
    values[:missing] = np.nan
    run = gt.Recording.from_arrays("day1", {"P": np.ones(400), "T": values}, sample_time=1.0)
    problem = make_problem(gt.DataSet([run], held_out_by_default=False), Plate(), [run])
    return replace(problem, initial=np.array([[start, inner]]), initial_free=np.array([True, True]))


@pytest.mark.parametrize("start", [24.0, 18.6])
def test_a_start_state_far_from_the_first_sample_is_told(start: float) -> None:
    """Seen: 18.6 degC where 22.11 was measured, and -4 m/s and 0.087 m where an encoder says 0; nothing was said."""
    (told,) = far_starts(begun(start))
    assert told.startswith(f"day1 is begun with T at {start:.4g} degC (first sample 22 ± 0.08)")
    assert "fixed = true" in told_far([told]) and "and 2 more experiments" in told_far([told] * 5)
    assert "and 1 more experiment:" in told_far([told] * 4)


def test_what_the_noise_explains_is_not() -> None:
    assert far_starts(begun(22.2)) == [] and far_starts(begun(22.2, inner=900.0)) == []
    assert far_starts(begun(23.0, counts=1.0)) == []


def test_a_state_that_is_held_is_not() -> None:
    assert far_starts(replace(begun(18.6), initial_free=np.array([False, True]))) == []


def test_a_sensor_that_begins_late_says_nothing_of_the_beginning() -> None:
    """Seen: the first sample that there is, 100 s later and 13 degrees higher, told as the one of the beginning."""
    assert far_starts(begun(22.0, missing=100)) == []


def test_a_state_that_the_card_gives_a_value_is_not_begun_as_measured() -> None:
    """Seen: told that the state "is declared to begin as measured", beside the value on the card."""
    assert far_starts(begun(18.6), given=["T"]) == [] and far_starts(begun(18.6), given=["inner"]) != []


def test_parameters_that_were_not_estimated_may_be_the_reason() -> None:
    """Seen: "makes up for something that the model lacks", of a simulation with start values that nobody had estimated."""
    assert "may make up for" in told_far(["a"]) and "parameters" not in told_far(["a"])
    assert "or for parameters that are not the machine's; [model.initial]" in told_far(["a"], estimated=False)
