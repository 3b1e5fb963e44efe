"""Units of one kind and of different size that meet without a factor."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.checking.examine import examine
from greybox_torch.checking.unit_sizes import differ, unit_size
from greybox_torch.systems import model_class

VESSEL = """
from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State


class Vessel(GreyBoxModel):
    states = [State("T", "degC")]
    inputs = [Input("power", "kW"), Input("air", "degC")]
    outputs = [Output("T", "degC")]
    parameters = [
        Parameter("C", 1e6, unit="J/K"),
        Parameter("UA", 20.0, unit="W/K"),
        Parameter("W", 1000.0, unit="W/kW", fixed=True),
    ]
    ports = [Balance("vessel", level="T")]

    def derivative(self, x, u, p, port):
        return {"T": (HEAT) / p.C}

    def output(self, x, u, p):
        return {"T": x.T}
"""
AXIS = """
from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Axis(GreyBoxModel):
    states = [State("place", "PLACE"), State("speed", "SPEED")]
    inputs = [Input("force", "N")]
    outputs = [Output("place", "SHOWN")]
    parameters = [Parameter("m", 1.0, unit="kg"), Parameter("d", 1.0, unit="DAMPING"), Parameter("n", 1000.0, unit="1")]
    ports = [Body("axis", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"place": RATE, "speed": (u.force - p.d * x.speed + port.axis) / p.m}

    def output(self, x, u, p):
        return {"place": OUT}
"""


def found(folder: Path, text: str, name: str) -> list[tuple[str, str]]:
    (folder / "machine.py").write_text(text)
    findings = examine(model_class(f"{folder / 'machine.py'}:{name}")).findings
    assert all(f.level == "warning" and (f.line or "output" in f.found) for f in findings if f.topic == "units")
    return [(f.found, f.write) for f in findings if f.topic == "units"]


@pytest.mark.parametrize(
    ("heat", "told", "write"),
    [
        (
            "u.power - p.UA * (x.T - u.air) + port.vessel",
            "subtracts `u.power`, in kW, and `p.UA * (x.T - u.air)`, in W",
            "`u.power` times 1000, or both in units of one size",
        ),
        (
            "p.UA * (u.air - x.T) + 0.5 * u.power",
            "adds `p.UA * (u.air - x.T)`, in W, and `u.power * 0.5`, in 1000 W",
            "`u.power * 0.5` times 1000, or both in units of one size",
        ),
        (
            "u.power + port.vessel",
            "the rate of state 'T' is in 1000 K/s, expected K/s",
            "what is there times 1000",
        ),
        ("1000 * u.power - p.UA * (x.T - u.air) + port.vessel", "", ""),
        ("p.W * u.power - p.UA * (x.T - u.air) + port.vessel", "", ""),
        ("p.W * u.power**200 / u.power**199 + port.vessel", "", ""),  # seen: OverflowError
        ("1e3 * (u.power + port.vessel) - p.UA * (x.T - u.air)", "", ""),
        ("p.UA * (u.air + 273.15 - x.T) + port.vessel", "", ""),
    ],
)
def test_a_sum_of_quantities_of_different_size(tmp_path: Path, heat: str, told: str, write: str) -> None:
    """Seen: a heater's kW added to a loss in W, and "nothing is wrong"."""
    assert found(tmp_path, VESSEL.replace("HEAT", heat), "Vessel") == ([(told, write)] if told else [])


@pytest.mark.parametrize(
    ("place", "speed", "damping", "shown", "rate", "out", "told"),
    [
        ("m", "m/s", "N s/m", "m", "x.speed", "x.place", ""),
        (
            "mm",
            "m/s",
            "N s/m",
            "mm",
            "x.speed",
            "x.place",
            "the rate of state 'place' is in m/s, expected mm per second",
        ),
        ("mm", "m/s", "N s/m", "mm", "1000 * x.speed", "x.place", ""),
        ("mm", "m/s", "N s/m", "mm", "p.n * x.speed", "x.place", ""),
        ("m", "m/s", "N s/m", "mm", "x.speed", "x.place", "output 'place' is in m, expected mm"),
        ("m", "m/s", "N s/mm", "m", "x.speed", "x.place", "subtracts `u.force`, in N, and `p.d * x.speed`, in 1000 N"),
    ],
)
def test_rates_and_outputs(
    tmp_path: Path, place: str, speed: str, damping: str, shown: str, rate: str, out: str, told: str
) -> None:
    text = AXIS
    words = {"PLACE": place, "SPEED": speed, "DAMPING": damping, "SHOWN": shown, "RATE": rate, "OUT": out}
    for word, unit in words.items():
        text = text.replace(word, unit)
    assert [what for what, _ in found(tmp_path, text, "Axis")] == ([told] if told else [])


@pytest.mark.parametrize(
    ("unit", "size"),
    [("kW", 1e3), ("N m/V", 1.0), ("degF", 5 / 9), ("-", 1.0), ("mm", 1e-3), ("%", None), ("1/min", None), ("", None), ("no unit", None)],
)  # fmt: skip
def test_the_size_of_a_unit(unit: str, size: float | None) -> None:
    assert unit_size(unit) == (None if size is None else pytest.approx(size))


def test_turns_may_be_counted_or_not() -> None:
    assert differ(unit_size("rpm"), unit_size("rad/s")) and differ(unit_size("deg"), unit_size("rad"))
    assert not differ(unit_size("rev/s"), unit_size("1/s")) and not differ(None, 1.0)
