"""The equation of a found law."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.describe.equation import equation
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, Coupling
from greybox_torch.model.ports import Actuator, Port

SIGNALS = ("speed", "position", "time", "deflection", "rate", "load", "input")
AROUND = Surroundings({name: Range(-1.0, 1.0, 1.0) for name in SIGNALS}, {}, "N m", 0.01)
DRUM, ROPE = Body("drum", speed="omega", position="angle"), Coupling("rope", deflection="stretch", rate="rate")
ACTUATOR = Actuator("actuator", "torque")
NAMED = {"speed": "omega", "position": "angle", "deflection": "stretch"}


def told(mechanism: Mechanism, site: Port = DRUM) -> str:
    names = [p.name for p in mechanism.parameters(AROUND) if p.name != "centre"]
    return equation(Attachment(site.name, mechanism), site, AROUND, lambda s: NAMED.get(s, s), names)


@pytest.mark.parametrize(
    ("mechanism", "options", "site", "expected"),
    [
        ("coulomb_friction", {}, DRUM, "port.drum += -F_c * tanh(omega / v_0)"),
        (
            "stribeck_friction",
            {},
            DRUM,
            "port.drum += -(F_c + F_s * exp(-(omega / v_s) ** 2)) * tanh(omega / v_0) - c * omega",
        ),
        ("torque_ripple", {}, DRUM, "port.drum += a * cos(order * angle) + b * sin(order * angle)"),
        (
            "backlash",
            {},
            ROPE,
            "the spring at rope sees stretch - min(max(stretch, -half_gap), half_gap); damping acts beside that",
        ),
        ("presliding_hysteresis", {}, DRUM, "−F z / z_0 with dz/dt = v − |v| z / z_0 (Dahl)"),
        ("input_gain", {}, ACTUATOR, "The input that acts is (1 + gain_error) u"),
        ("input_lag", {}, ACTUATOR, "w acts in the place of the input u: T dw/dt = u − w"),
        (
            "input_lag",
            {"second_order": True},
            ACTUATOR,
            "w acts in the place of the input u: (T/(2 damping))² d²w/dt² + T dw/dt = u − w",
        ),
        ("actuator_deadzone", {}, ACTUATOR, "The input acts only beyond ±half_width"),
        (
            "actuator_deadzone",
            {"by_direction": True},
            ACTUATOR,
            "The input acts only above (1 + asymmetry) half_width and below −(1 − asymmetry) half_width",
        ),
    ],
)
def test_equations(mechanism: str, options: dict[str, Any], site: Port, expected: str) -> None:
    """Seen: no formula anywhere; it had to be read back from the exported C."""
    assert told(LIBRARY[mechanism](**options), site) == expected


def test_a_curve_has_none_and_a_law_that_is_no_formula_its_description() -> None:
    class Odd(LIBRARY["coulomb_friction"]):
        """Sticks.

        More of it.
        """

        def force(self, s, p, z):
            return float(s.speed)

    assert told(Unknown("speed")) == ""
    assert told(Odd()) == "Sticks"


@pytest.mark.parametrize("mechanism", ["input_lag", "sensor_lag", "actuator_deadzone", "torque_saturation"])
@pytest.mark.parametrize("richer", [False, True])
def test_words_name_the_parameters_of_the_form_that_was_found_alone(mechanism: str, richer: bool) -> None:
    """Seen: an asymmetry and a damping in the law of a result that has neither."""
    law = LIBRARY[mechanism](richer)
    around = Surroundings({n: Range(-1.0, 1.0, 1.0) for n in ("input", "output", "speed")}, {}, "V", 0.01)
    for name in {"damping", "asymmetry", "base_speed"}:
        assert (name in law.described_here()) == (name in {p.name for p in law.parameters(around)})
    assert not [word for word in ("second_order", "by_direction", "ζ") if word in law.described_here()]


@pytest.mark.parametrize("mechanism", ["input_lag", "sensor_lag"])
def test_the_law_of_a_lag_is_the_one_of_its_documentation(mechanism: str) -> None:
    """Whatever words stand between the two forms there."""
    first, second = (LIBRARY[mechanism](richer) for richer in (False, True))
    assert first.described().startswith(first.described_here())
    assert second.described().endswith(second.described_here().split(": ")[1].replace("(2 damping)", "2ζ"))


def test_the_law_of_a_lag_does_not_hang_on_the_sentence_of_its_documentation() -> None:
    class Reworded(LIBRARY["input_lag"]):
        """A lag. Of second order it has a damping as well."""

    assert Reworded(True).described_here() == LIBRARY["input_lag"](True).described_here()
