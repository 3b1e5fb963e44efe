"""A list of a model that is none, or holds what is no declaration, is told with what to write, by check and by the class itself."""

from __future__ import annotations

from typing import Any

import pytest

import greybox_torch as gt

PORT = gt.Body("rotor", speed="speed")


def motor(**changed: Any) -> type[gt.GreyBoxModel]:
    declared = {
        "states": [gt.State("speed", "rad/s")],
        "inputs": [gt.Input("torque", "N m")],
        "outputs": [gt.Output("speed", "rad/s")],
        "parameters": [gt.Parameter("J", 0.1, unit="kg m^2")],
        "ports": [PORT],
        "derivative": lambda self, x, u, p, port: {"speed": (u.torque + port.rotor) / p.J},
        "output": lambda self, x, u, p: {"speed": x.speed},
    }
    return type("Motor", (gt.GreyBoxModel,), {**declared, **changed})


@pytest.mark.parametrize(
    ("changed", "found", "write"),
    [
        ({"states": ["speed"]}, "'states' holds 'speed', expected State(…)", 'states = [State("speed", "unit"), …]'),
        (
            {"states": gt.State("speed", "rad/s")},
            "'states' is a State, expected a list",
            'states = [State("…", "unit")]',
        ),
        ({"states": None}, "'states' is None, expected a list", 'states = [State("…", "unit")]'),
        ({"states": [gt.Output("speed", "rad/s")]}, "'states' holds an Output, expected State(…)", "states = "),
        ({"inputs": ["torque"]}, "'inputs' holds 'torque', expected Input(…)", 'inputs = [Input("torque", "unit"), …]'),
        ({"outputs": "speed"}, "'outputs' is 'speed', expected a list", 'outputs = [Output("…", "unit")]'),
        ({"parameters": {"J": 0.1}}, "'parameters' is a dict, expected a list", "parameters = "),
        ({"parameters": [("J", 0.1)]}, "'parameters' holds a tuple, expected Parameter(…)", "parameters = "),
        ({"ports": PORT}, "'ports' is a Body, expected a list", 'ports = [Body("…", speed="…")]'),
        ({"ports": ["rotor"]}, "'ports' holds 'rotor', expected Body(…)", 'ports = [Body("rotor", speed="…"), …]'),
    ],
)
def test_what_is_no_declaration(changed: dict[str, Any], found: str, write: str) -> None:
    """Seen: "checking it raised AttributeError: 'str' object has no attribute 'name'"."""
    made = motor(**changed)
    (one,) = gt.check(made).findings
    assert (one.level, one.found) == ("error", found) and one.write.startswith(write)
    with pytest.raises(gt.UserError, match=r"model Motor: ") as raised:
        made()
    assert str(raised.value).startswith(f"model Motor: {found}; write {write}")


def test_what_is_declared_passes() -> None:
    made = motor(states=(gt.State("speed", "rad/s"),))
    assert not [one for one in gt.check(made).findings if one.level == "error"]
    made()
