"""A law that makes up for a term of the wrong sign in the user's equations: a pendulum whose gravity pushes it away."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.api.verdict_summary import notes
from greybox_torch.diagnosis.describe.sign_of_term import turned
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.rates_and_outputs import RatesAndOutputs
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.mechanism import Range, Surroundings

AROUND = {"load": Surroundings({"position": Range(-3.0, 3.0, 1.5)}, {"position": "rad"}, "N m", 0.01)}
LAW, SAMPLES = "load.gravity", 600


class Wrong(gt.GreyBoxModel):
    """A pendulum with + m g L sin q."""

    states = (gt.State("q", "rad", initial="measured"), gt.State("w", "rad/s", initial="measured"))
    inputs = (gt.Input("torque", "N m"),)
    outputs = (gt.Output("q", "rad"), gt.Output("w", "rad/s"))
    parameters = (
        gt.Parameter("J", 1.2, unit="kg m^2", lower=0.01),
        gt.Parameter("b", 0.4, unit="N m s/rad", lower=0.0),
        gt.Parameter("m_g_L", 26.5, unit="N m", lower=0.0, fixed=True),
    )
    ports = (gt.Body("load", position="q", speed="w"),)
    sign = 1.0

    def derivative(self, x, u, p, port):
        return {
            "q": x.w,
            "w": (u.torque - p.b * x.w + self.sign * p.m_g_L * torch.sin(x.q) + port.load) / p.J,
        }

    def output(self, x, u, p):
        return {"q": x.q, "w": x.w}


class Right(Wrong):
    """With - m g L sin q."""

    sign = -1.0


def recorded(role: Literal["estimation", "validation"], seed: int) -> gt.Recording:
    draw = np.random.default_rng(seed)
    started = np.r_[0.0, np.full(SAMPLES - 1, np.nan)]
    given = {"torque": np.repeat(draw.uniform(-22.0, 22.0, SAMPLES // 30), 30), "q": started, "w": started}
    alone = gt.DataSet([gt.Recording.from_arrays(role, given, sample_time=0.02)], held_out_by_default=False)
    moved = gt.simulate(Right(), alone)[role]
    noisy = {n: moved[n] + 1e-3 * draw.normal(size=SAMPLES) for n in ("q", "w")}
    return gt.Recording.from_arrays(role, {**given, **noisy}, sample_time=0.02, role=role)


DATA = gt.DataSet([recorded("estimation", 1), recorded("validation", 2)])


def test_a_diagnosis_asks_for_the_sign_of_the_term() -> None:
    """Seen: gravity at load (0.85), a = 52.9, exactly twice m g L, and not a word of the sign."""
    verdict = gt.diagnose(Wrong(), DATA, time_limit=60).verdict
    (effect,) = verdict.effects
    assert effect.mechanism == "gravity"
    asked = (
        "it does what m_g_L = -26.5 N m would do (26.5 on the card): is the sign of that term in the equations right?"
    )
    assert effect.of_sign == asked in effect.remarks
    assert f"gravity at load: {asked}" in notes(verdict) and f"Gravity at load: {asked}" in verdict.evidence


@pytest.mark.parametrize(
    ("model", "lower", "fixed", "a", "found"),
    [
        (Wrong(), 0.0, True, 53.0, -26.5),
        (Wrong(), -np.inf, True, 53.0, -26.5),
        (Wrong(), 0.0, False, 53.0, -26.5),
        (Wrong(), -np.inf, False, 53.0, None),  # it may have that value
        (Wrong(), 0.0, True, 26.5, None),  # there is no such term
        (Wrong(), 0.0, True, 10.0, None),
        (Right(), 0.0, True, 10.0, None),  # more of it
        (Right(), 0.0, True, -53.0, -26.5),
    ],
)
def test_what_is_of_the_other_sign(
    model: Wrong, lower: float, fixed: bool, a: float, found: float | None, b: float = 0.0
) -> None:
    entry = {"value": 26.5, "lower": lower, "fixed": fixed}
    data = gt.DataSet(
        DATA.recordings, parameters={"m_g_L": entry if np.isfinite(lower) else {"value": 26.5, "fixed": fixed}}
    )
    law = attach(model, "load", Gravity())
    augmented = AugmentedModel(model, (law,), AROUND, switched=(law,))
    problem = make_problem(data, augmented, data.recordings)
    problem.lower[problem.names.index("m_g_L")] = lower
    draw = np.random.default_rng(0)
    states, inputs = torch.as_tensor(draw.normal(size=(2, 200))), torch.as_tensor(draw.normal(size=(1, 200)))
    values = {**problem.values_by_name, f"{LAW}.a": a, f"{LAW}.b": b, f"{LAW}.share": 1.0}
    changes = RatesAndOutputs(augmented, values, states, inputs)
    told = turned(changes, problem, [p.name for p in model.declared_parameters], f"{LAW}.share")
    assert told == (None if found is None else ("m_g_L", pytest.approx(found, rel=1e-6)))


def test_a_law_that_does_something_else_as_well() -> None:
    test_what_is_of_the_other_sign(Wrong(), 0.0, True, 53.0, None, b=20.0)
