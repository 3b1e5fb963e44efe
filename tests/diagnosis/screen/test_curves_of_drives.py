"""Curves of what drives a body beyond a lag, and of what two balances exchange where the model has a port for it."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.diagnosis.screen.further_curves import further_curves
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.model.exchanges import exchange_between
from greybox_torch.model.states_at_no_port import driving_states
from greybox_torch.systems.robot_arm import RobotArm


class Coil(GreyBoxModel):
    """A coil on a spring; its current lags behind the command."""

    states: ClassVar = [State("x", "m"), State("v", "m/s"), State("i", "A"), State("heat", "K")]
    inputs: ClassVar = [Input("command", "A")]
    outputs: ClassVar = [Output("x", "m")]
    parameters: ClassVar = [Parameter("K", 12.0), Parameter("T", 0.01)]
    ports: ClassVar = [
        Body("coil", speed="v", position="x"),
        Coupling("spring", deflection="x", rate="v"),
        Balance("warmth", level="heat"),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {
            "x": x.v,
            "v": p.K * x.i - x.x - port.spring + port.coil,
            "i": (u.command - x.i) / p.T,
            "heat": x.i**2 - x.heat + port.warmth,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"x": x.x}


class Loaded(Coil):
    """The same, where the model tells what loads the coil."""

    ports: ClassVar = [Body("coil", speed="v", position="x", load=lambda x, u, p: p.K * x.i), *Coil.ports[1:]]


class Plates(GreyBoxModel):
    """A heat exchanger with a port for the heat that goes through its plates, in the direction given."""

    states: ClassVar = [State("hot", "K"), State("cold", "K")]
    inputs: ClassVar = [Input("flow", "kg/s")]
    outputs: ClassVar = [Output("cold", "K")]
    parameters: ClassVar = [Parameter("UA", 1.0)]
    ports: ClassVar = [
        Balance("hot_side", level="hot"),
        Balance("cold_side", level="cold"),
        Balance("plates", level=lambda x, u, p: x.hot - x.cold),
    ]
    goes_over = 1.0

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        heat = p.UA * (x.hot - x.cold) + port.plates
        return {
            "hot": (-heat + port.hot_side) / 2.0,
            "cold": (self.goes_over * heat - u.flow * x.cold + port.cold_side) / 3.0,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"cold": x.cold}


class Lossy(Plates):
    """The same, where half of the heat is lost on its way: the port is no exchange."""

    goes_over = 0.5


def ways(model: GreyBoxModel) -> list[tuple[str, str, str]]:
    return [(port.name, curve.signal, curve.factor) for port, curve in further_curves(model, 6)]


def surrounded(model: GreyBoxModel, states: list[float]) -> dict[str, Surroundings]:
    wave = 1.0 + 0.5 * np.sin(np.arange(40.0) / 5)
    signals = {one.name: wave for one in (*model.inputs, *model.outputs)}
    problem = make_problem(
        gt.DataSet([recording := gt.Recording.from_arrays("run", signals, sample_time=1.0)]), model, (recording,)
    )
    return surroundings_along(model, problem, np.outer(np.linspace(0.0, 1.0, problem.records.u.shape[1]), states))


def test_a_state_drives_a_body_where_it_moves_it_and_is_told_at_no_port() -> None:
    model = Coil()
    assert driving_states(model, model.ports[0]) == ["i"]


def test_what_drives_a_body_is_offered_by_itself_and_by_where_the_body_is() -> None:
    """Seen: a voice coil's force by its stroke, told at the actuator, before the current's lag, with a lag of the sensor (0.97 both)."""
    found = [way for way in ways(Coil()) if "state@i" in way]
    assert found == [("coil", "state@i", ""), ("coil", "position", "state@i"), ("coil", "speed", "state@i")]


def test_where_the_load_tells_of_it_the_load_is_taken() -> None:
    around = surrounded(Loaded(), [1.0, 1.0, 2.0, 1.0])
    found = [way for way in ways(Loaded()) if "load" in way or "state@i" in way]
    assert found == [("coil", "load", ""), ("coil", "position", "load"), ("coil", "speed", "load")]
    offered = {a.mechanism.signals() for a in candidates(Loaded(), {}, around, flexible=True) if a.port == "coil"}
    assert ("position", "load") in offered
    assert around["coil"].ranges["load"].high == pytest.approx(24.0)


def test_a_load_that_springs_make_is_none_that_drives() -> None:
    assert not [way for way in ways(RobotArm()) if "load" in way]


def test_the_curve_by_a_state_multiplies_it() -> None:
    model = Coil()
    around = surrounded(model, [1.0, 1.0, 2.0, 1.0])
    assert around["coil"].units["state@i"] == "A"
    assert signal_name(model, model.ports[0], "state@i") == "i"
    augmented = AugmentedModel(model, [attach(model, "coil", Unknown("position", 6, "state@i"))], around)
    p = Signals("parameter", {q.name: torch.tensor(q.value) for q in augmented.declared_parameters})
    p = p.replaced(**{n: torch.tensor(0.5) for n in p if ".w_" in n})
    u, none = Signals("input", {"command": torch.tensor(0.0)}), {q.name: torch.tensor(0.0) for q in model.all_ports}

    def force(current: float) -> float:
        values = {"x": 0.5, "v": 0.0, "i": current, "heat": 0.0}
        x = Signals("state", {n: torch.tensor(v) for n, v in values.items()})
        with_curve, without = (m.derivative(x, u, p, Signals("port", none)) for m in (augmented, model))
        return float(with_curve["v"] - without["v"])

    assert abs(force(1.0)) > 0.1 and force(3.0) == pytest.approx(3.0 * force(1.0), rel=1e-5)


def test_a_state_that_the_model_has_not_is_refused() -> None:
    model = Coil()
    around = surrounded(model, [1.0, 1.0, 2.0, 1.0])
    with pytest.raises(UserError, match=r"no state 'charge', which the effect at 'coil' depends on \(it has: x, v, i"):
        AugmentedModel(model, [attach(model, "coil", Unknown("position", 6, "state@charge"))], around)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_port_of_an_exchange_is_found_in_either_direction(order: tuple[int, int]) -> None:
    model = Plates()
    one, other = (model.ports[k] for k in order)
    assert isinstance(one, Balance) and isinstance(other, Balance)
    assert exchange_between(model, one, other) is model.ports[2]
    assert exchange_between(Lossy(), one, other) is None


def test_an_exchange_is_offered_at_its_own_port() -> None:
    """Seen: the flow's effect on the heat through an exchanger's plates, told at the hot side (0.97)."""
    found = [way for way in ways(Plates()) if way[0] == "plates" and way[2] == "level"]
    assert ("plates", "input@flow", "level") in found and ("plates", "level@hot_side", "level") in found
    assert not [way for way in ways(Plates()) if "difference@" in "".join(way)]
    assert ("hot_side", "input@flow", "difference@cold_side") in ways(Lossy())


class Battery(GreyBoxModel):
    """A cell whose voltage falls in proportion to its charge; what its resistance takes is shown beside that."""

    states: ClassVar = [State("soc"), State("sag", "V")]
    inputs: ClassVar = [Input("current", "A")]
    outputs: ClassVar = [Output("voltage", "V"), Output("charge")]
    parameters: ClassVar = [Parameter("Q", 3600.0), Parameter("E", 0.6)]
    ports: ClassVar = [Balance("store", level="soc")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"soc": (-u.current + port.store) / p.Q, "sag": u.current - x.sag}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"voltage": p.E * x.soc - x.sag, "charge": x.soc}


def test_a_curve_over_what_a_sensor_shows_beside_others_is_offered() -> None:
    """Seen: a real cell's open-circuit voltage by its charge, for which there was no word: without a name, 18 times the noise."""
    found = {way for way in ways(Battery()) if way[0].startswith("sensor")}
    assert found == {("sensor.voltage", "state@soc", ""), ("sensor.voltage", "state@sag", "")}, (
        "the charge is shown alone"
    )


def test_the_curve_is_added_to_the_output_alone() -> None:
    model = Battery()
    around = surrounded(model, [1.0, 0.5])
    augmented = AugmentedModel(model, [attach(model, "sensor.voltage", Unknown("state@soc", 6))], around)
    p = Signals("parameter", {q.name: torch.tensor(q.value) for q in augmented.declared_parameters})
    p = p.replaced(**{n: torch.tensor(0.5) for n in p if ".w_" in n})
    x = Signals("state", {"soc": torch.tensor(0.5), "sag": torch.tensor(0.1)})
    u = Signals("input", {"current": torch.tensor(1.0)})
    none = Signals("port", dict.fromkeys((q.name for q in model.all_ports), torch.tensor(0.0)))
    with_curve, without = augmented.outputs_with(x, u, p, none), model.output(x, u, p)
    assert float(with_curve["voltage"] - without["voltage"]) > 0.4 and with_curve["charge"] == without["charge"]
    assert around["sensor.voltage"].ranges["state@soc"].high == pytest.approx(1.0)
    assert augmented.derivative(x, u, p, none)["soc"] == model.derivative(x, u, p, none)["soc"]
