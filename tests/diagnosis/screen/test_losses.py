"""What a balance loses to surroundings whose level is an input, and inputs that a model has no equation for."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.screen import further_curves
from greybox_torch.diagnosis.screen.candidates import candidates, memory_candidates
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.model.idle_inputs import idle_inputs, ports_in_use


class Collector(GreyBoxModel):
    """A plate in the sun; the wind is recorded, and nobody has an equation for it."""

    states: ClassVar = [State("plate", "degC", initial="measured"), State("salt", "kg")]
    inputs: ClassVar = [Input("sun", "W"), Input("outside", "degC"), Input("wind", "m/s")]
    outputs: ClassVar = [Output("plate", "degC")]
    parameters: ClassVar = [Parameter("C", 100.0, unit="J/K"), Parameter("U", 2.0, unit="W/K")]
    ports: ClassVar = [Balance("heat", level="plate"), Balance("store", level="salt")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        shining = torch.where(u.sun > 50.0, u.sun, 0.0 * u.sun)
        return {
            "plate": (shining - p.U * (x.plate - u.outside) + port.heat) / p.C,
            "salt": port.store + 0.0 * x.salt,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"plate": x.plate}


class Windy(Collector):
    """The same, that uses its inputs through a copy of them."""

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return super().derivative(x, u.replaced(sun=u.sun + 0.0), p, port)


@pytest.fixture(scope="module")
def around() -> dict[str, Surroundings]:
    model, wave = Collector(), 1.0 + 0.5 * np.sin(np.arange(40.0) / 5)
    signals = {"sun": 100 * wave, "outside": 10 * wave, "wind": wave, "plate": 40 * wave}
    recording = gt.Recording.from_arrays("run", signals, sample_time=1.0)
    problem = make_problem(gt.DataSet([recording]), model, (recording,))
    return surroundings_along(model, problem, np.outer(np.linspace(0.5, 1.0, problem.records.u.shape[1]), [60.0, 1.0]))


def test_a_loss_to_the_surroundings_is_offered_by_itself_and_by_other_inputs(around) -> None:
    """Seen: a solar collector that the wind cools, told as complete near the noise, else with a bias of the wind beside a curve."""
    model, apart = Collector(), "above@outside"
    curves = [a for a in candidates(model, {}, around, flexible=True) if isinstance(a.mechanism, Unknown)]
    found = [(a.port, a.mechanism.signal, a.mechanism.factor) for a in curves if apart in a.mechanism.signals()]
    assert found == [("heat", apart, ""), ("heat", "input@wind", apart), ("heat", "input@sun", apart)], "the wind first"
    assert around["heat"].units[apart] == "degC" and apart not in around["store"].ranges
    assert signal_name(model, model.ports[0], apart) == "plate - outside"


def test_no_more_than_a_few(monkeypatch) -> None:
    monkeypatch.setattr(further_curves, "MOST_LOST", 2)
    assert [c.factor for _, c in further_curves._lost(Collector(), 6)] == ["", "above@outside"]


def test_the_loss_acts_on_its_balance_alone(around) -> None:
    model = Collector()
    augmented = AugmentedModel(model, [attach(model, "heat", Unknown("input@wind", 6, "above@outside"))], around)
    p = Signals("parameter", {q.name: torch.tensor(q.value) for q in augmented.declared_parameters})
    p = p.replaced(**{n: torch.tensor(-0.5) for n in p if ".w_" in n})
    none = Signals("port", dict.fromkeys((q.name for q in model.all_ports), torch.tensor(0.0)))

    def lost(plate: float, outside: float) -> float:
        x = Signals("state", {"plate": torch.tensor(plate), "salt": torch.tensor(0.0)})
        u = Signals("input", {n: torch.tensor(v) for n, v in (("sun", 0.0), ("outside", outside), ("wind", 1.0))})
        plain, now = model.derivative(x, u, p, none), augmented.derivative(x, u, p, none)
        assert float(now["salt"]) == float(plain["salt"])
        return 100.0 * float(now["plate"] - plain["plate"])

    assert lost(40.0, 40.0) == pytest.approx(0.0, abs=1e-4)
    assert lost(50.0, 30.0) == pytest.approx(2.0 * lost(40.0, 30.0), rel=1e-4) != 0.0


def test_nothing_is_offered_at_the_actuator_of_an_input_that_the_model_does_not_read(around) -> None:
    model = Collector()
    assert idle_inputs(model) == {"wind"}, "what acts beyond a threshold alone is read"
    assert idle_inputs(Windy()) == frozenset(), "of a copy it is not known what is read"
    assert [q.name for q in ports_in_use(model)] == ["heat", "store", "actuator.sun", "actuator.outside", "sensor"]
    offered = [a for flexible in (True, False) for a in candidates(model, {}, around, flexible=flexible)]
    offered += memory_candidates(model, around)
    ports = {a.port for a in offered}
    assert {"actuator.sun", "actuator.outside"} <= ports and "actuator.wind" not in ports
    (together,) = (a for a in offered if a.prefix.endswith("_of_all"))
    assert "wind" not in together.mechanism.reads
