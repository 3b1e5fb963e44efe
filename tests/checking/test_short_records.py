"""Validation experiments that are too short to judge by are told."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.checking.short_records import short_records
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.short_validation import short_validation, slowest_time_constant

CONSTANT = 500.0


class Plate(gt.GreyBoxModel):
    """A heated plate whose time constant is C / h."""

    states = (gt.State("T", "degC", initial="measured"),)
    inputs = (gt.Input("P", "W"),)
    outputs = (gt.Output("T", "degC"),)
    parameters = (gt.Parameter("C", 2.0 * CONSTANT, unit="J/K"), gt.Parameter("h", 2.0, unit="W/K"))

    def derivative(self, x, u, p, port):
        return {"T": (u.P - p.h * x.T) / p.C}

    def output(self, x, u, p):
        return {"T": x.T}


def data(estimation: float, validation: float) -> gt.DataSet:
    """Experiments that last so many seconds."""
    ends = {"estimation": estimation, "validation": validation}
    runs = []
    for role, end in ends.items():
        count = round(end / 2.0)
        signals = {"P": np.sin(np.arange(count)), "T": np.cos(np.arange(count))}
        runs.append(gt.Recording.from_arrays(role, signals, sample_time=2.0, role=role))
    return gt.DataSet(runs)


@pytest.mark.parametrize(
    ("estimation", "validation", "beside"),
    [
        (5000.0, 80.0, ["5000 s of estimation", "a slowest time constant of 500 s"]),
        (5000.0, 200.0, ["a slowest time constant of 500 s"]),
        (20000.0, 300.0, ["20000 s of estimation"]),
        (5000.0, 400.0, []),
        (900.0, 200.0, []),
    ],
)
def test_what_a_validation_experiment_is_short_beside(estimation: float, validation: float, beside: list[str]) -> None:
    """Seen: 80 s of a machine with minutes passed every check. Where estimation shows no more, nothing is said."""
    told = [warning.found for warning in short_records(data(estimation, validation), Plate())]
    assert len(told) == bool(beside)
    for what in beside:
        assert what in told[0] and f"the validation experiment lasts {validation:.3g} s" in told[0]
    assert sum(told[0].count(word) for word in ("of estimation", "time constant")) == len(beside) if beside else True


def test_a_delay_that_was_found() -> None:
    assert short_validation(data(600.0, 80.0), None, {"T of input delay at P": 14.0}) is not None
    assert short_validation(data(600.0, 200.0), None, {"T of input delay at P": 14.0}) is None


def test_the_slowest_time_constant_of_a_model() -> None:
    recordings = data(600.0, 80.0)
    problem = make_problem(recordings, Plate(), recordings.estimation())
    assert slowest_time_constant(Plate(), problem) == pytest.approx(CONSTANT)


def test_a_quarter_that_was_held_out_by_default_is_as_long_as_it_is() -> None:
    whole = data(5000.0, 80.0).estimation()
    assert not list(short_records(gt.DataSet(whole), Plate()))
