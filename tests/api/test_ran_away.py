"""Estimates that ran away are told in a sentence."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import greybox_torch as gt
from greybox_torch.api.ran_away import ran_away
from greybox_torch.estimate.fit import Estimation
from tests.api.motor import Motor
from tests.api.test_fit_many import motors


def test_parameters() -> None:
    """Seen: a parameter of 1e+87 in the table, without a word; and damping at 414 times its start value, of a fit of -42 %."""
    (data,) = motors(1)
    own = gt.DataSet(data.recordings, parameters={"J": {"value": 0.02}})
    found = gt.fit(Motor(), own).estimation
    assert ran_away(found, own, 99.0) is None
    assert ran_away(found, own, 20.0) is None
    k = found.problem.names.index("J")

    def at(value: float, deviation: float = 1e-4) -> Estimation:
        values = np.where(np.arange(len(found.problem.names)) == k, value, found.problem.values)
        return wider(replace(found, problem=replace(found.problem, values=values)), deviation)

    away = ran_away(at(1e87), own, 99.0)
    assert away is not None and away.startswith("Ran away: J = 1e+87 kg m^2 (begun with 0.02). ")
    away = ran_away(at(8.0, 0.1), own, -42.0)
    assert away is not None and away.startswith("Ran away: J = 8 kg m^2 (begun with 0.02). ")
    assert ran_away(at(8.0, 0.1), own, 99.0) is None, "a start value far off, and a good fit"
    assert ran_away(at(8.0), own, -42.0) is None, "far off, and well determined"


class Shaft(gt.GreyBoxModel):
    """A motor and a drum on a shaft whose twist nothing measures."""

    states = [gt.State("motor", "rad/s", "measured"), gt.State("drum", "rad/s", "measured"), gt.State("twist", "rad")]
    inputs = [gt.Input("torque", "N m")]
    outputs = [gt.Output("motor", "rad/s"), gt.Output("drum", "rad/s")]
    parameters = [gt.Parameter("k", 20.0, unit="N m/rad", lower=1.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        rate = x.motor - x.drum
        force = p.k * x.twist + 0.5 * rate
        return {"motor": u.torque - force - 0.1 * x.motor, "drum": (force - 0.2 * x.drum) / 2.0, "twist": rate}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"motor": x.motor, "drum": x.drum}


def test_start_states_that_nothing_measures() -> None:
    """Seen: twist = -13925 rad (std 97580) at the start of every experiment, in the table alone."""
    torque = np.repeat(np.random.default_rng(0).uniform(-1.0, 1.0, 20), 20)
    units = {"torque": "N m", "motor": "rad/s", "drum": "rad/s"}
    blank = {"torque": torque, "motor": 0.0 * torque, "drum": 0.0 * torque}
    runs = gt.simulate(
        Shaft(),
        gt.DataSet([gt.Recording.from_arrays("a", blank, sample_time=0.02, units=units)], held_out_by_default=False),
    )
    measured = {"torque": torque, "motor": runs["a"]["motor"], "drum": runs["a"]["drum"]}
    recordings = [gt.Recording.from_arrays(name, measured, sample_time=0.02, units=units) for name in ("a", "b")]
    data = gt.DataSet(recordings, held_out_by_default=False)
    found = gt.fit(Shaft(), data).estimation
    assert ran_away(found, data, 99.0) is None
    far = found.problem.initial.copy()
    far[:, 2] = (-9e3, -1.4e4)
    found = wider(replace(found, problem=replace(found.problem, initial=far)), 1e5)
    away = ran_away(found, data, 99.0)
    assert away is not None and away.startswith("Ran away: twist = -1.4e+04 rad where b begins (± ")
    assert "; with the start values it stays within 0.0" in away and " rad), as far in 1 more. " in away


def wider(found: Estimation, deviation: float) -> Estimation:
    """With the same standard deviation of all unknowns."""
    known = found.uncertainty
    assert known is not None
    covariance = deviation**2 * np.eye(len(known.plain))
    return replace(found, uncertainty=replace(known, plain=covariance, sandwich=covariance))
