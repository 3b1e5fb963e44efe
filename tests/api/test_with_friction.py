"""A channel of the other sign or unit on a drive with dry friction that the model lacks: neither slip alone explains the recordings."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api import short_refits, with_friction
from greybox_torch.api.rescaled import of_units
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from tests.api.rotor import STEP, recorded, recordings

TORQUES = (-4.0, 12.0)


class Drive(gt.GreyBoxModel):
    """A rotor with viscous friction alone."""

    states = (gt.State("speed", "rad/s", initial="measured"),)
    inputs = (gt.Input("torque", "N m"),)
    outputs = (gt.Output("speed", "rad/s"),)
    parameters = (
        gt.Parameter("J", 0.4, unit="kg m^2", lower=0.01),
        gt.Parameter("b", 0.05, unit="N m s/rad", lower=0.0),
    )
    ports = (gt.Body("rotor", speed="speed"),)

    def derivative(self, x, u, p, port):
        return {"speed": (u.torque - p.b * x.speed + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}


@pytest.mark.parametrize(("sign", "level", "asked"), [(-1.0, 5.0, True), (1.0, 5.0, False)])
def test_the_sign_is_asked_for_with_the_friction_that_lacks(sign: float, level: float, asked: bool) -> None:
    """Seen: "the channels seem to be what the card says" of a conveyor's torque of the other sign."""
    data = recordings(level, torques=TORQUES, sign=sign)
    question = gt.fit(Drive(), data).question
    assert (question is not None) is asked, question
    if question is not None:
        assert question.startswith(
            "Is the sign of torque turned, or is the sign of speed turned? So changed, and with Coulomb"
        )
        assert "Coulomb friction at rotor, a short refit reaches a mean fit of 9" in question


class Axis(Drive):
    """The same with the way that it goes."""

    states = (*Drive.states, gt.State("place", "m", initial="measured"))
    outputs = (*Drive.outputs, gt.Output("place", "m"))

    def derivative(self, x, u, p, port):
        return {**super().derivative(x, u, p, port), "place": 0.03 * x.speed}

    def output(self, x, u, p):
        return {"speed": x.speed, "place": x.place}


@pytest.mark.parametrize(("factor", "asked"), [(30.0 / np.pi, "9.55 times smaller"), (1.0, "")])
def test_a_unit_is_asked_for_with_the_friction_that_lacks(factor: float, asked: str) -> None:
    """Seen: a motor's rpm read as rad/s; a mass at its bound and a friction of the other body made up for it, and nothing was asked."""
    runs = []
    for k, role in enumerate(("estimation", "validation"), start=1):
        run = recorded(role, k, 5.0, torques=TORQUES)
        way = 0.03 * STEP * np.cumsum(run.signals["speed"])
        signals = {"torque": run.signals["torque"], "speed": factor * run.signals["speed"], "place": way - way[0]}
        runs.append(gt.Recording.from_arrays(role, signals, sample_time=STEP, role=role))
    question = gt.fit(Axis(), gt.DataSet(runs)).question
    assert (question is not None) is bool(asked), question
    if question is not None:
        assert question.startswith("Is the scale of speed right? With values ") and asked in question
        assert ", and with Coulomb friction at rotor, a short refit reaches a mean fit of 9" in question


class Train(Drive):
    """The same with several sensors of the speed."""

    outputs = tuple(gt.Output(f"speed{k}", "rad/s") for k in range(3))


class Pair(Drive):
    outputs = Train.outputs[:2]


def test_of_units_only_as_many_changes_as_are_worth_a_refit(monkeypatch: pytest.MonkeyPatch) -> None:
    """No decades, of which no start value says which is nearer, and no more than ``MOST_UNITS`` refits."""
    factors = sorted(change.factor for change in of_units(Drive()))
    known = (60.0, 180.0 / np.pi, 30.0 / np.pi)
    assert factors == pytest.approx(sorted([*known, *(1.0 / one for one in known)]))
    tried: list[int] = []
    monkeypatch.setattr(with_friction, "_rubbing", lambda *given: (None, None))
    monkeypatch.setattr(with_friction, "as_it_is", lambda *given: 0.0)
    monkeypatch.setattr(with_friction, "nearest", lambda *given: [])
    monkeypatch.setattr(with_friction, "far_better", lambda *given, **how: tried.append(len(given[3])))
    data = recordings(5.0, torques=TORQUES)
    for model in (Drive(), Pair(), Train()):
        assert with_friction.changed_with_friction(data, model, None, 0.0) is None  # pyright: ignore[reportArgumentType]
    assert tried[::2] == [0, 0, 0], "signs, which are asked about first"
    assert tried[1::2] == [6, with_friction.MOST_UNITS, 0]


def test_the_model_with_friction_is_made_and_refitted_as_it_is_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: a survey, a simulator and a refit with the friction alone for the signs, and the same again for the units."""
    surveys, refitted = [], []

    def fit_after(data, model, simulator, change, **given):
        refitted.extend([change.question] if given.get("refitted", True) else [])
        return 10.0

    survey = with_friction.survey
    monkeypatch.setattr(with_friction, "survey", lambda *given: surveys.append(1) or survey(*given))
    for module in (with_friction.nearest, short_refits.far_better):
        monkeypatch.setitem(module.__globals__, "fit_after", fit_after)
    data = recordings(5.0, torques=TORQUES)
    simulator = simulator_for(make_problem(data, Drive(), data.estimation()))
    assert with_friction.changed_with_friction(data, Drive(), simulator, 0.0) is None
    assert len(surveys) == 1 and refitted.count("") == 1
    assert any("sign" in one for one in refitted) and any("scale" in one for one in refitted)
