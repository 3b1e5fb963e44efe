from __future__ import annotations

from typing import Any

import pytest
import torch

from greybox_torch.errors import UserError
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.model.check import check_equations


class Tank(GreyBoxModel):
    states = [State("level", "m")]
    inputs = [Input("inflow", "m^3/s")]
    outputs = [Output("level", "m")]
    parameters = [Parameter("area", 2.0, "m^2", lower=0.1, description="of the base")]
    ports = [Balance("tank", level="level")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"level": (u.inflow + port.tank) / p.area}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"level": x.level}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"value": -1.0, "lower": 0.0}, r"Parameter 'k': value -1 lies outside its bounds \[0, inf\]"),
        ({"value": 3.0, "upper": 2.0}, r"value 3 lies outside its bounds \[-inf, 2\]"),
        ({"value": 1.0, "lower": 2.0, "upper": 1.0}, "lower bound 2 is not below upper bound 1"),
        ({"value": 1.0, "lower": 1.0, "upper": 1.0}, "lower bound 1 is not below upper bound 1"),
        ({"value": float("nan")}, "value nan lies outside its bounds"),
    ],
)
def test_parameter_that_contradicts_itself(options: dict[str, float], message: str) -> None:
    with pytest.raises(UserError, match=message):
        Parameter("k", **options)


def test_start_value_of_a_state() -> None:
    assert State("speed", initial="measured").initial == "measured"
    with pytest.raises(UserError, match="State 'speed': initial is 'mesured', expected a number or 'measured'"):
        State("speed", initial="mesured")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("declarations", "message"),
    [
        ({"states": []}, "model Changed: 'states' is empty"),
        ({"outputs": []}, "'outputs' is empty"),
        ({"states": [State("level"), State("level")]}, "'states' names level twice"),
        ({"parameters": [Parameter("k", 1.0), Parameter("k", 2.0)]}, "'parameters' names k twice"),
        ({"ports": [Body("rotor", speed="level"), Balance("rotor", level="level")]}, "'ports' names rotor twice"),
    ],
)
def test_declarations_that_do_not_make_a_model(declarations: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        type("Changed", (Tank,), declarations)()


def test_parameters_stay_a_method_of_the_module() -> None:
    tank = Tank()
    assert [p.name for p in tank.declared_parameters] == ["area"]
    assert [tuple(p.shape) for p in torch.nn.Module.parameters(tank)] == [()]
    assert list(tank.state_dict()) == ["raw.area"]


def test_the_parameters_of_another_model_are_declared_parameters() -> None:
    """Seen: "p.Kv: no parameter has this name; declared are: none", six times."""
    with pytest.raises(UserError, match=r"model Mine: 'parameters' .* expected \[\*Other.declared_parameters\]"):

        class Mine(GreyBoxModel):
            parameters = GreyBoxModel.parameters


def test_values_are_not_given_to_the_class() -> None:
    """Seen: a bare TypeError of `Press(b=3)`."""

    class Mine(GreyBoxModel):
        states, outputs, parameters = [State("x")], [Output("x")], [Parameter("b", 1.0)]

    with pytest.raises(UserError, match=r"^Mine\(\) takes no values; expected them in set_values"):
        Mine(b=3.0)


def test_a_subclass_inherits_the_parameters() -> None:
    class Taller(Tank):
        states = [State("level", "m", initial=3.0)]

    assert Taller().values() == {"area": 2.0}


@pytest.mark.parametrize(
    ("inputs", "outputs", "expected"),
    [
        (["a"], ["y"], ["actuator", "sensor"]),
        (["a", "b"], ["y", "z"], ["actuator.a", "actuator.b", "sensor.y", "sensor.z"]),
        ([], ["y"], ["sensor"]),
    ],
)
def test_actuator_and_sensor_ports(inputs: list[str], outputs: list[str], expected: list[str]) -> None:
    changed = type(
        "Changed", (Tank,), {"inputs": [Input(n) for n in inputs], "outputs": [Output(n) for n in outputs], "ports": []}
    )()
    assert [port.name for port in changed.all_ports] == expected


def test_signals_of_ports() -> None:
    body = Body("rotor", speed="speed", load=lambda x, u, p: x.speed)
    assert (body.kind, list(body.signals)) == ("body", ["speed", "load"])
    assert list(Coupling("spring", deflection="twist", rate="rate").signals) == ["deflection", "rate"]
    actuator, sensor = Tank().all_ports[1:]
    u = Signals("input", {"inflow": 4.0})
    assert actuator.signals["input"](None, u, None) == 4.0  # type: ignore[operator]
    assert sensor.signals == {}


def test_a_port_adds_to_the_rates() -> None:
    x, u, p = torch.zeros(1, 3), torch.ones(1, 3), Tank().physical()
    pushed = Tank().derivative(
        Signals("state", {"level": x[0]}), Signals("input", {"inflow": u[0]}), p, Signals("port", {"tank": 3.0})
    )
    assert pushed["level"].tolist() == [2.0, 2.0, 2.0]
    assert Tank().rates(x, u, p).tolist() == [[0.5, 0.5, 0.5]]


def test_set_values() -> None:
    tank = Tank()
    tank.set_values({"area": 4.0})
    assert tank.values() == {"area": 4.0}
    with pytest.raises(UserError, match=r"model Tank has no parameter 'depth' \(it has: area\)"):
        tank.set_values({"depth": 1.0})
    with pytest.raises(UserError, match=r"no parameter 'aera' \(did you mean \"area\"\?\)"):
        tank.set_values({"aera": 1.0})
    with pytest.raises(UserError, match=r"parameter 'area' of model Tank: 0.05 lies outside its bounds \[0.1, inf\]"):
        tank.set_values({"area": 0.05})


def test_a_name_in_other_capitals_is_meant_first() -> None:
    """Seen: T suggested for TJ, beside Tj."""
    with pytest.raises(UserError, match=r'did you mean "Tj"'):
        Signals("state", {"T": 1.0, "Tj": 2.0})["TJ"]


def test_names_that_are_not_declared() -> None:
    values = Signals("state", {"level": 1.0})
    assert values.level == values["level"] == 1.0
    assert (list(values), len(values)) == (["level"], 1)
    assert values.replaced(level=2.0).level == 2.0
    with pytest.raises(
        UserError,
        match=r"the state 'levl' \(did you mean \"level\"\?\), which is not declared \(declared: level\)$",
    ):
        values.levl  # noqa: B018


@pytest.mark.parametrize(
    ("method", "result", "message"),
    [
        ("derivative", lambda x: {}, r"Changed.derivative\(\) returned nothing; expected level"),
        ("derivative", lambda x: {"level": x.level, "speed": x.level}, "returned level, speed; expected level"),
        ("derivative", lambda x: x.level, "returned Tensor; expected a dictionary with the keys level"),
        ("output", lambda x: {"depth": x.level}, r"Changed.output\(\) returned depth; expected level"),
        (
            "output",
            lambda x: {"level": torch.stack([x.level, x.level])},
            r"Changed.output\(\) returned 'level' of shape \(2, 3\)",
        ),
        (
            "output",
            lambda x: {"level": torch.ones(2)},
            r"returned 'level' of shape \(2,\) for signals of shape \(3,\); exp",
        ),
        ("output", lambda x: {"level": 1 / 0}, r"test_declarations.py, line \d+: .* raised ZeroDivisionError"),
        ("output", lambda x: {"level": x.level if x.level > 0 else 0.0}, r"torch.where\(condition, yes, no\)"),
    ],
)
def test_equations_that_are_not_usable(method: str, result: Any, message: str) -> None:
    def equation(self: Any, x: Any, *_: Any) -> Any:
        return result(x)

    changed = type("Changed", (Tank,), {method: equation})
    with pytest.raises(UserError, match=message):
        check_equations(changed())


def test_equations_that_are_missing() -> None:
    class Bare(GreyBoxModel):
        states = [State("level")]
        outputs = [Output("level")]

    with pytest.raises(UserError, match=r"Bare does not define derivative\(x, u, p, port\)"):
        check_equations(Bare())


def test_equations_that_are_sound() -> None:
    check_equations(Tank())
