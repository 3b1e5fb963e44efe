"""What is said of the force at a port whose speed is not that of a body that turns or slides."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.checking.examine import examine
from greybox_torch.data.angles import has_angle
from greybox_torch.systems import model_class

HOOP = """
from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Hoop(GreyBoxModel):
    states = [State("speed", "V")]
    inputs = [Input("u", "-")]
    outputs = [Output("speed", "V")]
    parameters = [Parameter("k", 8.3, unit="V/s"), Parameter("b", 0.82, unit="1/s")]
    ports = [Body("hoop", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": p.k * u.u - p.b * x.speed + port.hoop}

    def output(self, x, u, p):
        return {"speed": x.speed}
"""


@pytest.mark.parametrize(("unit", "force"), [("V", ""), ("-", ""), ("rad/s", "N m"), ("m/s", "N"), ("A", "V")])
def test_the_force_at_a_body_has_a_unit_where_its_product_with_the_speed_is_power(
    tmp_path: Path, unit: str, force: str
) -> None:
    """Seen: a torque "in A" beside a speed in a tachometer's volts, and a parameter in "A^2 s^4/(m^2 kg)" asked for."""
    rate = {"-": "1/s", "rad/s": "rad/s^2", "m/s": "m/s^2"}.get(unit, f"{unit}/s")
    (tmp_path / "hoop.py").write_text(HOOP.replace('"V/s"', f'"{rate}"').replace('"V"', f'"{unit}"'))
    found = examine(model_class(f"{tmp_path / 'hoop.py'}:Hoop")).findings
    assert [f"`port.hoop`, in {force}" in finding.found for finding in found] == ([True] if force else [])


@pytest.mark.parametrize(
    ("unit", "told"),
    [
        ("N m/V", "N m A/V"),
        ("N*m/V", "N m A/V"),
        ("W/°C", "W A/°C"),
        ("N m/(rad/s)", "A m^2 kg/s"),
        ("N m", "N m A"),
        ("V s/rad", "N m"),
    ],
)
def test_a_product_is_told_in_the_units_of_its_factors(tmp_path: Path, unit: str, told: str) -> None:
    """Seen: `p.k_t * u.current`, in A^2 s."""
    text = HOOP.replace('Input("u", "-")', 'Input("u", "A")').replace('"V/s"', f'"{unit}"').replace('"V"', '"rad/s"')
    (tmp_path / "hoop.py").write_text(text)
    found = " ".join(f.found for f in examine(model_class(f"{tmp_path / 'hoop.py'}:Hoop")).findings)
    assert f"`p.k * u.u`, in {told}" in found


@pytest.mark.parametrize("unit", ["-", "1", "%"])
def test_a_product_with_a_number_is_told_so_too_and_not_as_an_equation_that_is_divided(
    tmp_path: Path, unit: str
) -> None:
    """Seen: "in A^2 s/(m^2 kg)"; "`port.r` divided by the parameter in m^2 kg/(A^2 s^3) that the equation is divided by"."""
    text = HOOP.replace('Input("u", "-")', 'Input("u", "A")').replace('"V/s"', '"N m/V"').replace('"V"', '"rad/s"')
    text = text.replace(
        "parameters = [", f'parameters = [Parameter("J", 1.0, unit="kg m^2"), Parameter("n", 80.0, unit="{unit}"), '
    )
    text = text.replace("p.k * u.u - p.b * x.speed + port.hoop", "(p.n * p.k * u.u + port.hoop) / p.J - p.b * x.speed")
    (tmp_path / "hoop.py").write_text(text)
    (finding,) = [f for f in examine(model_class(f"{tmp_path / 'hoop.py'}:Hoop")).findings if "`port.hoop`" in f.found]
    assert "`p.n * p.k * u.u`, in N m A/V, and `port.hoop`, in N m" in finding.found
    assert "divided by the parameter" not in finding.write and "p.k [N m/V]" in finding.write


LAG = HOOP.replace("p.k * u.u - p.b * x.speed + port.hoop", "RATE").replace(
    'Parameter("k", 8.3, unit="V/s")', 'Parameter("tau", 0.2, unit="s")'
)


@pytest.mark.parametrize(
    ("unit", "rate", "told"),
    [
        ("1", "u.u - x.speed", "is in 1, expected 1/s\nwrite: a rate in 1/s"),
        ("-", "(u.u - x.speed) / p.tau", ""),
        ("rad", "u.u - x.speed", "is in 1, expected rad/s\nwrite: a rate in rad per second"),
        ("m", "u.u / p.tau", "is in 1/s, expected m/s\nwrite: a rate in m per second"),
        ("m", "u.u / p.tau * torch.cos(x.speed / x.speed)", "is in 1/s, expected m/s\nwrite: a rate in m per second"),
        ("A", "x.speed * p.tau", "is in A s, expected A/s\nwrite: a rate in A per second"),
        ("1", "0.0", ""),
        ("V", "2.5", ""),
    ],
)
def test_the_rate_of_a_plain_number_is_in_1_s_and_a_number_is_in_any_unit(
    tmp_path: Path, unit: str, rate: str, told: str
) -> None:
    """Seen: "the rate of state 'spool' is in 1, expected rad/s", of a state of unit 1 whose rate is 0.0."""
    (tmp_path / "lag.py").write_text("import torch\n" + LAG.replace('"V"', f'"{unit}"').replace("RATE", rate))
    findings = examine(model_class(f"{tmp_path / 'lag.py'}:Hoop")).findings
    found = [f"{f.found}\nwrite: {f.write}" for f in findings if f.found.startswith("the rate of")]
    assert found == ([f"the rate of state 'speed' {told}"] if told else [])


@pytest.mark.parametrize(
    ("heat", "unit", "told"),
    [
        ("p.P * u.valve / 100", "J/K", ""),
        ("p.P * u.valve / 100", "J", "is in 1/s, expected K/s\nwrite: a rate in K/s"),
        ("p.P * 0.01 * u.valve", "J", "is in 1/s, expected K/s\nwrite: a rate in K/s"),
        ("p.P * u.valve / 300", "J", ""),
    ],
)
def test_energy_does_not_turn_and_a_hundred_of_percent_is_plain(
    tmp_path: Path, heat: str, unit: str, told: str
) -> None:
    """Seen: "the rate of state 'air' is in rad/s, expected K/s", and "a rate in degC per second" below it, of J written for J/K."""
    (tmp_path / "zone.py").write_text(ZONE.replace("HEAT", heat).replace("UNIT", unit))
    findings = examine(model_class(f"{tmp_path / 'zone.py'}:Zone")).findings
    found = [f"{f.found}\nwrite: {f.write}" for f in findings if f.topic == "units"]
    assert found == ([f"the rate of state 'air' {told}"] if told else [])


ZONE = """
from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State


class Zone(GreyBoxModel):
    states, inputs, outputs = [State("air", "degC")], [Input("valve", "%")], [Output("air", "degC")]
    parameters = [Parameter("P", 25000.0, unit="W"), Parameter("C", 4e6, unit="UNIT")]
    ports = [Balance("air", level="air")]

    def derivative(self, x, u, p, port):
        return {"air": HEAT / p.C + port.air}

    def output(self, x, u, p):
        return {"air": x.air}
"""


@pytest.mark.parametrize(("unit", "told"), [("1", ", in 1/s"), ("", ""), ("m", ", in m per second")])
def test_a_rate_that_is_left_out_is_told_with_its_unit(tmp_path: Path, unit: str, told: str) -> None:
    (tmp_path / "lag.py").write_text(LAG.replace('"V"', f'"{unit}"').replace('"speed": RATE', '"other": 0.0'))
    (write,) = [
        f.write
        for f in examine(model_class(f"{tmp_path / 'lag.py'}:Hoop")).findings
        if f.found.endswith("does not return it")
    ]
    assert write == f'"speed": … in what derivative() returns{told}'


@pytest.mark.parametrize(
    ("made", "turning"),
    [("rad/s", True), ("°/s", True), ("rpm", True), ("N m s/rad", True), ("1/s", False), ("Hz", False), ("°C", False)],
)
def test_units_with_an_angle(made: str, turning: bool) -> None:
    assert has_angle(made) == turning
