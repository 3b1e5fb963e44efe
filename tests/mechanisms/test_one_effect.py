"""Laws that are one effect in a model, whatever is recorded of the machine."""

from __future__ import annotations

from pathlib import Path

import torch

from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.mechanisms.actuator import InputBias, InputDelay, InputGain, InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.one_effect import one_effect
from greybox_torch.mechanisms.sensor import OutputDelay, SensorBias
from greybox_torch.systems import load_model


class DisplayCase(GreyBoxModel):
    """Air and goods of a refrigerated display case, whose compressor is on or off."""

    states = [State("air", "degC"), State("goods", "degC")]
    inputs = [Input("compressor"), Input("ambient", "degC")]
    outputs = [Output("air", "degC"), Output("goods", "degC")]
    parameters = [
        Parameter("C", 12e3, unit="J/K", lower=100.0),
        Parameter("UA", 20.0, unit="W/K", lower=0.0),
        Parameter("UAg", 30.0, unit="W/K", lower=0.0),
        Parameter("Q", 900.0, unit="W"),
    ]
    ports = [Balance("air_heat", level="air"), Balance("goods_heat", level="goods")]

    def derivative(self, x, u, p, port):
        exchange = p.UAg * (x.air - x.goods)
        heat = p.UA * (u.ambient - x.air) - exchange - p.Q * u.compressor + port.air_heat
        return {"air": heat / p.C, "goods": (exchange + port.goods_heat) / (10.0 * p.C)}

    def output(self, x, u, p):
        return {"air": x.air, "goods": x.goods}


class Throttled(DisplayCase):
    """The same where no more cold comes than the compressor's limit allows."""

    def derivative(self, x, u, p, port):
        return super().derivative(x, u.replaced(compressor=torch.tanh(u.compressor)), p, port)


class OfPressures(DisplayCase):
    """The same with rates that are numbers above zero alone."""

    def derivative(self, x, u, p, port):
        rates = super().derivative(x, u, p, port)
        return {**rates, "goods": rates["goods"] + torch.sqrt(x.goods)}


AROUND = Surroundings({}, {}, "W", 10.0)
AIR, GOODS = ("air_heat", ConstantBias()), ("goods_heat", ConstantBias())
COMPRESSOR, AMBIENT = ("actuator.compressor", InputBias()), ("actuator.ambient", InputBias())
LAG = ("actuator.compressor", InputLag())


def same(first, second, *shared, of=DisplayCase, gain=0.1) -> bool:
    """Whether two laws, (port, mechanism) each, are one effect beside others."""
    base = of()
    around = {port.name: AROUND for port in base.all_ports}
    one, other = (AugmentedModel(base, [Attachment(*a) for a in (*shared, law)], around) for law in (first, second))
    sizes = {"bias": 0.1, "gain_error": gain, "T": 20.0}
    own, its = (
        {p.name: sizes.get(p.name.split(".")[-1], p.value) for p in m.declared_parameters} for m in (one, other)
    )
    return one_effect(one, other, own, its)


def test_offsets_that_are_the_same_heat() -> None:
    """Seen: told "to tell them apart: a record with zero input", and `greybox design` found none."""
    assert same(AIR, COMPRESSOR) and same(COMPRESSOR, AIR) and same(AIR, AMBIENT) and same(COMPRESSOR, AMBIENT)
    assert same(AIR, COMPRESSOR, of=OfPressures)


def test_offsets_at_other_places() -> None:
    assert not same(AIR, GOODS) and not same(COMPRESSOR, GOODS)
    assert not same(AIR, ("sensor.air", SensorBias()))


def test_a_law_that_adds_nothing_is_not_compared() -> None:
    assert not same(("actuator.ambient", InputGain()), AIR, gain=0.0)


def test_an_offset_before_a_limit_is_not_the_same_as_one_behind_it() -> None:
    assert not same(AIR, COMPRESSOR, of=Throttled) and same(AIR, AMBIENT, of=Throttled)


def test_a_lag_passes_an_offset_on_and_a_gain_later() -> None:
    assert same(AIR, COMPRESSOR, LAG)
    gain = ("actuator.compressor", InputGain())
    assert not same(gain, AIR, LAG) and not same(gain, ("actuator.ambient", InputGain()), LAG)


def test_laws_of_several_parameters_are_left_undecided() -> None:
    assert not same(LAG, ("actuator.ambient", InputLag())) and not same(LAG, AIR)


def test_a_delay_before_the_only_input_and_behind_the_only_output(machines: Path) -> None:
    motor = load_model(f"{machines / 'motor.py'}:Motor")
    around = {port.name: AROUND for port in motor.all_ports}
    early, late, bias = (
        AugmentedModel(motor, [Attachment(port, law)], around)
        for port, law in (("actuator", InputDelay()), ("sensor", OutputDelay()), ("rotor", ConstantBias()))
    )
    assert one_effect(early, late, early.values(), late.values())
    assert not one_effect(early, bias, early.values(), bias.values())
    of_two = (("actuator.compressor", InputDelay()), ("sensor.air", OutputDelay()))
    assert not same(*of_two)
