"""What looks like noise in a recording, and that the model follows: a voltage that jumps with the current."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.diagnosis.hypothesis.noise import floor_known, noise_floor, output_floors
from greybox_torch.diagnosis.select.plain_model import fit_plain_model, weighted_by_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.model import Balance, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import SimulationOptions

SETTINGS, STEP, NOISE = DiagnosisSettings(), 2.0, 1e-3


class Cell(GreyBoxModel):
    """A resistance in series with a resistance and a capacity in parallel, and how warm they get."""

    states: ClassVar = [State("v", "V"), State("warm", "K")]
    inputs: ClassVar = [Input("i", "A")]
    outputs: ClassVar = [Output("voltage", "V"), Output("warm", "K")]
    parameters: ClassVar = [
        Parameter("R0", 0.05, unit="Ohm", lower=1e-3),
        Parameter("R1", 0.02, unit="Ohm", lower=1e-3),
        Parameter("tau", 60.0, unit="s", lower=1.0),
        Parameter("C", 50.0, unit="J/K", lower=1.0),
    ]
    ports: ClassVar = [Balance("polarisation", level="v"), Balance("heat", level="warm")]

    def derivative(self, x, u, p, port):
        heat = p.R0 * u.i**2 - 0.1 * x.warm
        return {"v": (p.R1 * u.i - x.v) / p.tau + port.polarisation, "warm": (heat + port.heat) / p.C}

    def output(self, x, u, p):
        return {"voltage": p.R0 * u.i + x.v, "warm": x.warm}


def recorded(series: float) -> gt.DataSet:
    """The exact answer of a cell with the resistance ``series`` (Ohm) to steps of current, with white noise."""
    rng = np.random.default_rng(4)
    i = np.repeat(rng.uniform(-3.0, 3.0, 120), 6)
    v, warm = np.zeros(len(i)), np.zeros(len(i))
    slow, cool = np.exp(-STEP / 60.0), np.exp(-STEP * 0.1 / 50.0)
    for k in range(len(i) - 1):
        v[k + 1] = slow * v[k] + (1 - slow) * 0.02 * i[k]
        warm[k + 1] = cool * warm[k] + (1 - cool) * 10.0 * 0.05 * i[k] ** 2
    clean = {"voltage": series * i + v, "warm": warm}
    noisy = {n: y + NOISE * rng.standard_normal(len(i)) for n, y in clean.items()}
    return gt.DataSet([gt.Recording.from_arrays("steps", {"i": i, **noisy}, sample_time=STEP)])


def weighted(data: gt.DataSet) -> tuple[Problem, Problem]:
    """The problem before and after a first fit has told how large the noise can be."""
    model = Cell()
    problem = all_starts_free(data, make_problem(data, model, data.recordings))
    study, state = fit_plain_model(Study(problem, SimulationOptions()))
    return problem, weighted_by_noise(study, state).problem


def test_what_the_model_follows_is_no_noise() -> None:
    """Seen: a thermometer's lag in a battery, 10 times the noise, told as "nothing is missing": its voltage hid it."""
    before, after = weighted(recorded(series=0.05))
    assert (output_floors(before, SETTINGS)[0] / NOISE**2)[0] > 100.0, "what the recording alone shows"
    assert output_floors(after, SETTINGS)[0, 0] == pytest.approx(NOISE**2, rel=0.2)
    np.testing.assert_array_equal(output_floors(after, SETTINGS)[0, 1], output_floors(before, SETTINGS)[0, 1])
    assert noise_floor(after, SETTINGS) < 0.02 * noise_floor(replace(after, most_noise=None), SETTINGS)
    assert not floor_known(after, SETTINGS), "what a fit leaves may be more than noise"


def test_noise_that_no_fit_goes_below_stands_as_the_recording_shows_it() -> None:
    before, after = weighted(recorded(series=0.0))
    assert after.most_noise is None
    np.testing.assert_array_equal(output_floors(after, SETTINGS), output_floors(before, SETTINGS))
