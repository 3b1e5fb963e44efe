"""What is found in models that are sound, and in the documentation's motor with one thing changed."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.checking.examine import Examination, examine
from greybox_torch.systems import model_class

RATE = '{"speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J}'
RETURN = f"return {RATE}"
OUTPUT = 'return {"speed": x.speed}'
STATES = 'states = [State("speed", "rad/s")]'
TORCH = "from greybox_torch import Body"
J = 'Parameter("J", 0.01, unit="kg m^2", lower=0.0),'
B = 'Parameter("b", 0.10, unit="N m s/rad", lower=0.0),'


def line_of(text: str, part: str) -> int:
    return next(k for k, line in enumerate(text.splitlines(), 1) if part in line)


def examined(folder: Path, machines: Path, *changes: tuple[str, str]) -> tuple[Examination, str]:
    text = "import math, random\nimport numpy as np\nimport torch\n" + (machines / "motor.py").read_text()
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    (folder / "motor.py").write_text(text)
    return examine(model_class(f"{folder / 'motor.py'}:Motor")), text


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("motor.py", "Motor"),
        ("pendulum.py", "Pendulum"),
        ("small.py", "Slide"),
        ("small.py", "Tank"),
        ("small.py", "Cart"),
        (None, "robot_arm"),
    ],
)
def test_nothing_is_found_in_sound_models(machines: Path, file: str | None, name: str) -> None:
    found = examine(model_class(name if file is None else f"{machines / file}:{name}"))
    assert found.findings == ()
    assert found.compiled


def rate(old: str, new: str) -> tuple[str, str]:
    """The change of a part of the rate."""
    return RETURN, RETURN.replace(old, new)


# What is changed, the level, what is found, what is to be written, and a part of the line that is named.
FAULTS = {
    "undeclared parameter": (rate("p.b", "p.c"), "error", "p.c: no parameter has this name", "", "p.c"),
    "misspelt input": (rate("u.voltage", "u.volage"), "error", '(did you mean "voltage"?)', "u.", "volage"),
    "undeclared port": (rate("port.rotor", "port.gear"), "error", "port.gear: no port", "Body", "gear"),
    "by item": (rate("x.speed", 'x["spede"]'), "error", "x.spede: no state", "State", "spede"),
    "state without a rate": (
        (STATES, 'states = [State("speed", "rad/s"), State("angle", "rad")]'),
        "error", "state 'angle' is declared, but derivative() does not return it", '"angle": …', "return {",
    ),
    "output not returned": (
        (OUTPUT, "return {}"),
        "error", "output 'speed' is declared, but output()", "rad/s", "return {}",
    ),
    "unknown rate": (rate('{"speed"', '{"spede"'), "error", "returns 'spede'", "speed", "spede"),
    "port of no state": (
        ('speed="speed")]', 'speed="velocity")]'),
        "error", 'speed = "velocity" is not a state', "lambda", "velocity",
    ),
    "if": (
        (RETURN, f"if x.speed > 0:\n            return {RATE}\n        {RETURN}"),
        "error", "an `if` on a signal", "torch.where", "if x",
    ),
    "ternary by way of a name": (
        (RETURN, f"w = 2 * x.speed\n        s = 1.0 if w > 0 else -1.0\n        return {{'speed': s * {RATE}['speed']}}"),
        "error", "if condition else b", "torch.where", "s = 1.0",
    ),
    "item": (rate("x.speed", "x.speed.item()"), "error", "`.item()`", "as a tensor", "item"),
    "numpy": (rate("p.b * x.speed", "np.sin(x.speed)"), "error", "`np.sin` on a signal", "torch.sin", "np.sin"),
    "math": (rate("p.b * x.speed", "math.sin(x.speed)"), "error", "`math.sin`", "torch.sin", "math.sin"),
    "max": (rate("p.b * x.speed", "max(x.speed, u.voltage)"), "error", "`max`", "torch.maximum", "max("),
    "and": (
        rate("port.rotor", "torch.where(x.speed > 0 and u.voltage > 0, port.rotor, 0.0)"),
        "error", "`and` between conditions", "&", "torch.where(",
    ),
    "in place": (
        (RETURN, f"w = torch.zeros(2, dtype=x.speed.dtype)\n        w[0] = x.speed\n        {RETURN.replace('x.speed', 'w[0]')}"),
        "error", "writes into `w` in place", "torch.stack", "w[0] =",
    ),
    "random": (rate("p.b * x.speed", "p.b * x.speed * random.random()"), "error", "other values", "no random", "class"),
    "not compiled": (
        rate("p.b * x.speed", "p.b * torch.special.i0(x.speed)"),
        "warning", "has no compiled form", "torch.where", "i0",
    ),
    "rate in another unit": (
        rate(" / p.J", ""),
        "warning", "rate of state 'speed' is in N m, expected rad/s^2", "", "return {",
    ),
    "added": (
        rate("p.b * x.speed", "p.b"),
        "warning", "subtracts `p.k * u.voltage`, in N m, and `p.b`, in N m s/rad", "p.b [N m s/rad]", "return {",
    ),
    "function of a unit": (
        rate("p.b * x.speed", "p.b * torch.sin(x.speed)"), "warning", "takes sin of `x.speed`", "", "sin",
    ),
    "output in another unit": (
        (OUTPUT, OUTPUT.replace("x.speed", "x.speed * p.b")),
        "warning", "output 'speed' is in N m", "rad/s", "x.speed * p.b",
    ),
    "port not as a force": (
        rate(" + port.rotor) / p.J", ") / p.J + port.rotor"), "warning", "`port.rotor`, in N m",
        "`port.rotor` divided by the parameter in kg m^2", "return {",
    ),
    "unit that is none": ((B, B.replace("N m s/rad", "Nmsrad")), "warning", '"Nmsrad" is not a unit', "rad/s", '"b"'),
    "number in a unit": (
        (B, B.replace("N m s", "1e6 N m s")), "warning", "it begins with a number", '"N m s/rad", with the factor 1e6', '"b"',
    ),
    "parameter without effect": (
        (B, B + ' Parameter("F_c", 0.1, unit="N m"),'), "warning", "parameter 'F_c' moves no output", "p.F_c", '"F_c"',
    ),
    "parameter of a condition": (
        (RETURN, RETURN.replace("port.rotor", "torch.where(x.speed > p.b, port.rotor, 0.0)").replace("p.b * x.speed", "x.speed")),
        "warning", "parameter 'b' moves no output: it stands only where a change of it has no slope", "sigmoid", '"b"',
    ),
    "port that reaches nothing": (
        rate(" + port.rotor", ""),
        "warning", "port 'rotor' reaches no output", "port.rotor", '"rotor"',
    ),
    "input that moves nothing": (
        rate("p.k * u.voltage", "p.k"),
        "warning", "input 'voltage' moves no output", "u.voltage", '"voltage"',
    ),
    "not finite": (
        rate("p.b * x.speed", "p.b * torch.sqrt(x.speed)"), "warning", "random points", "clamp", "torch.sqrt",
    ),
    "start that is divided by": (
        rate("p.b * x.speed", "0.0 * u.voltage / x.speed"),
        "warning", "no number at the start (states at their start values, measured ones and inputs at zero), where speed = 0",
        "a denominator", "/ x.speed",
    ),
    "parameter of zero that is divided by": (
        (J, J.replace("0.01", "0.0").replace(", lower=0.0", "")), "warning", "at the start", "a value other than 0 for J", "return {",
    ),
    "negative inertia": (
        (J, J.replace("0.01", "-0.01").replace(", lower=0.0", "")),
        "warning", "J begins at -0.01 kg m^2: with a negative inertia a model runs away", "above zero", '"J"',
    ),
    "name of a method": ((B, B.replace('"b"', '"items"')), "error", "'items' is a method", "another name", '"items"'),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_fault(tmp_path: Path, machines: Path, fault: str) -> None:
    change, level, found, write, line = FAULTS[fault]
    result, text = examined(tmp_path, machines, change)
    matching = [f for f in result.findings if f.level == level and found in f.found]
    assert matching, [str(f) for f in result.findings]
    assert write in matching[0].write
    assert matching[0].file == tmp_path / "motor.py"
    assert matching[0].line == line_of(text, line)
    if level == "warning":
        assert all(f.level != "error" for f in result.findings)


def test_all_names_are_told_at_once(tmp_path: Path, machines: Path) -> None:
    result, _ = examined(tmp_path, machines, (RETURN, RETURN.replace("p.b", "p.c").replace("u.voltage", "u.current")))
    assert [f.found.split(":")[0] for f in result.findings] == ["u.current", "p.c"]


def test_equations_may_ask_about_their_arguments(tmp_path: Path, machines: Path) -> None:
    """Questions that the value of a signal does not answer, and branches on settings, are no fault."""
    asked = f"""if "speed" in x and self.title:
            scale = 1.0 if x.speed.dtype == torch.float64 else 1.0
        for k in range(2):
            scale = scale * float(k + 1) / (k + 1)
        return {{"speed": scale * {RATE}["speed"]}}"""
    result, _ = examined(tmp_path, machines, (RETURN, asked))
    assert result.findings == ()


def test_numbers_may_carry_units(tmp_path: Path, machines: Path) -> None:
    changed = RETURN.replace("p.b * x.speed", "(0.37 * x.speed + 0.1 + torch.sqrt(x.speed**2 + 1e-6) * 0.05)")
    result, _ = examined(tmp_path, machines, (RETURN, changed), (B, ""))
    assert result.findings == ()


def test_what_a_clamp_hides_beyond_small_values_moves_the_output(tmp_path: Path, machines: Path) -> None:
    """Seen: a magnetic bearing of 0.4 mm under a clamped command, whose gains and reference "move no output"."""
    clamped = rate("p.k * u.voltage", "torch.clamp(1e6 * p.k * u.voltage, -0.8, 0.8)")
    found, _ = examined(tmp_path, machines, clamped)
    assert not [f for f in found.findings if "moves no output" in f.found]


def test_an_input_that_only_a_port_reads_is_a_note(tmp_path: Path, machines: Path) -> None:
    """Seen: a log's hold-down force and a blade's bending moment, recorded for the friction that grows with them."""
    carried = ('Body("rotor", speed="speed"', 'Body("rotor", speed="speed", load=lambda x, u, p: 2.0 * u.hold')
    result, text = examined(
        tmp_path, machines, carried, ('Input("voltage", "V")', 'Input("voltage", "V"), Input("hold", "N")')
    )
    (found,) = result.findings
    assert (found.level, found.line) == ("note", line_of(text, '"hold"'))
    assert (
        found.found
        == "input 'hold' moves no output: laws that are attached at port 'rotor' may depend on it, the model does not"
    )
    assert "it as it is" in found.write and "u.hold in derivative()" in found.write


def test_a_state_that_nothing_shows_is_a_note(machines: Path) -> None:
    result = examine(model_class(f"{machines / 'small.py'}:WarmRotor"))
    assert [(f.level, f.topic) for f in result.findings] == [("note", "influence")]
    assert "state 'warmth' is neither measured nor acts" in result.findings[0].found


def test_a_class_without_equations() -> None:
    from greybox_torch import GreyBoxModel, Output, State

    class Empty(GreyBoxModel):
        states, outputs = [State("a")], [Output("a")]

    found = [f.found for f in examine(Empty).findings]
    assert found[:2] == ["derivative() is not defined", "output() is not defined"]


def test_ports_that_are_added_to_what_does_not_fit() -> None:
    """Seen: KeyError, where a port is added to what misfits already."""
    from greybox_torch import Coupling, GreyBoxModel, Input, Output, Parameter, State

    class Sledge(GreyBoxModel):
        states, outputs, inputs = [State("x", "m"), State("v", "m/s")], [Output("x", "m")], [Input("base", "m")]
        parameters = [Parameter("k", 50.0, unit="N/m"), Parameter("r", 2.0, unit="m")]
        ports = [
            Coupling("spring", deflection=lambda x, u, p: u.base - x.x, rate=lambda x, u, p: -x.v),
            Coupling("lever", deflection=lambda x, u, p: p.r * x.x, rate=lambda x, u, p: p.r * x.v),
            Coupling("screw", deflection=lambda x, u, p: p.r * u.base - x.x, rate=lambda x, u, p: -x.v),
        ]

        def derivative(self, x, u, p, port):
            return {"x": x.v, "v": p.k * (u.base - x.x) + port.spring - port.lever + port.screw}

        def output(self, x, u, p):
            return {"x": x.x}

    assert "units" in {f.topic for f in examine(Sledge).findings}
