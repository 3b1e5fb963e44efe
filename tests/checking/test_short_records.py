"""Validation experiments that are too short to judge by are told."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.checking.short_records import short_records
from greybox_torch.estimate.short_validation import short_validation

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


def test_a_lag_is_shown_by_less_than_a_delay() -> None:
    """Seen: every time of an effect was taken for a delay, ten of which an experiment has to last: a lag's time constant as well."""
    lag = {"T of input lag at P": 14.0}
    assert short_validation(data(600.0, 80.0), constants=lag) is None
    told = short_validation(data(600.0, 20.0), constants={"T of input lag at P": 60.0})
    assert told is not None and "short beside T of input lag at P of 60 s: hardly more than its beginning" in told


def test_what_is_short_beside_estimation_alone_may_be_long_for_the_machine() -> None:
    """Seen: 60 s of a motor with 0.1 s beside an hour, of which "hardly more than its beginning is judged"."""
    told = short_validation(data(3600.0, 60.0), 0.1)
    assert told == "the validation experiment lasts 60 s, which is short beside 3600 s of estimation"


def test_what_is_summed_is_told_as_a_sum() -> None:
    """Seen: "the longest validation experiment lasts 40 s", where all of them together had been compared."""
    signals = {"P": np.ones(20), "T": np.ones(20)}
    more = gt.Recording.from_arrays("more", signals, sample_time=2.0, role="validation")
    several = gt.DataSet([*data(5000.0, 40.0).recordings, more])
    together = "the validation experiments last 80 s together, which is short beside 5000 s of estimation"
    assert short_validation(several) == together
    assert short_validation(several, 500.0) == (
        f"{together}; the longest validation experiment lasts 40 s, which is short beside a slowest time constant of 500 s by the model's "
        "values: hardly more than its beginning is judged"
    )


def test_a_quarter_that_was_held_out_by_default_is_as_long_as_it_is() -> None:
    whole = data(5000.0, 80.0).estimation()
    assert not list(short_records(gt.DataSet(whole), Plate()))


def test_estimation_experiments_that_are_short_beside_the_machine() -> None:
    """Seen: an hour of a wall of two days passed every check, and C came out ten thousand times too large."""
    *_, told = short_records(data(24.0, 24.0), Plate())
    assert "lasts 24 s, 4.8 % of the slowest time constant, 500 s by the model's values" in told.found
    assert not list(short_records(data(40.0, 40.0), Plate()))


def test_few_samples_for_what_is_unknown() -> None:
    signals = {"P": np.sin(np.arange(10)), "T": np.cos(np.arange(10))}
    signals["T"][2:9] = np.nan
    runs = [
        gt.Recording.from_arrays(role, signals, sample_time=20.0, role=role) for role in ("estimation", "validation")
    ]
    (told,) = short_records(gt.DataSet(runs), Plate())
    assert told.found.startswith("[[experiment]]: 3 measured values for 2 parameters and 1 start state to estimate")
