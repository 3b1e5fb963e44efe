"""Derivatives that have grown without bound are said to have, and the data are not blamed; bounds are told but for rounding."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import torch

from greybox_torch.api.fit_summary import warnings
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability import identifiability
from greybox_torch.estimate.notes import at_a_bound, notes
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.termination import Termination
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator


class Dry(GreyBoxModel):
    """A motor with dry friction, which is too fast for steps of 10 ms where v_0 is small: what then holds it at rest is the sign alone."""

    states = [State("speed", "rad/s", initial="measured")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("J", 0.1), Parameter("F", 1.0), Parameter("v_0", 1.0, lower=0.001)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (0.5 * u.voltage - p.F * torch.tanh(x.speed / p.v_0)) / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


def problem_of(data_set: Any, experiments: list[Any]) -> Problem:
    data = data_set({"voltage": "V", "speed": "rad/s"}, experiments)
    return make_problem(data, Dry(), data.estimation())


def test_the_numbers_are_blamed_and_not_the_data(experiments: list[Any], data_set: Any) -> None:
    """Seen: v_0 at its bound, every parameter "undetermined", and "excite the machine more"; with v_0 held the same data gave them all."""
    problem = problem_of(data_set, experiments)
    sound = fit_records(problem)
    assert all(np.isfinite(list(sound.parameter_deviations().values())))
    fast = problem.with_values(np.array([0.1, 3.0, 0.001 * (1.0 + 1e-15)]))
    run = FreeRun(fast, Simulator.of(fast.model, fast.free_names))
    (found,) = identifiability(run, run.start)
    assert (found.kind, found.parameters, found.undetermined) == ("numbers", ("J", "F", "v_0"), False)
    ended = replace(sound, problem=fast, identifiability=(found,), notes=notes(fast, (found,)))
    assert [note.kind for note in ended.notes] == [Termination.at_bound]
    first, second = warnings(ended)
    assert first.startswith("At a bound: v_0 ≥ 0.001; ")
    assert second.startswith("No standard deviation is known") and "the numbers that failed" in second


def test_a_value_beside_its_bound_by_rounding_is_at_it() -> None:
    assert at_a_bound(0.010000000000000004, 0.01, np.inf) and at_a_bound(0.0, 0.0, 1.0) and at_a_bound(1.0, 0.0, 1.0)
    assert at_a_bound(3.66e-13, 0.0, 39.0) and not at_a_bound(1e-6, 0.0, 39.0), (
        "seen: a width of 3.66e-13 degC, without a remark"
    )
    assert (
        not at_a_bound(0.0101, 0.01, np.inf)
        and not at_a_bound(1e-12, 0.0, 1.0)
        and not at_a_bound(3.0, -np.inf, np.inf)
    )
