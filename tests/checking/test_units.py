"""What is said of the force at a port whose speed is not that of a body that turns or slides."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.checking.examine import examine
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
