"""Equations that raise or draw random numbers are told once, at the line that does it."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
import torch

from greybox_torch.checking.examine import examine
from greybox_torch.errors import UserError
from greybox_torch.model.check import check_equations
from greybox_torch.systems import load_model, model_class

RATE = "p.b * x.speed"
RETURN = 'return {"speed": (p.k'

# What is put in front of the first return, what in the place of the friction, what is found, what is to be written, a part of the line.
FAULTS = {
    "raises": (
        'raise ValueError("stuck")',
        RATE,
        "the equations of Motor raised ValueError: stuck",
        "raise nothing",
        "raise",
    ),
    "torch": ("", "p.b * torch.rand(()) * x.speed", "`rand` draws random numbers", "no random numbers", "torch.rand"),
    "one sample": (
        "",
        "p.b * torch.rand(1) * x.speed",
        "`rand` draws random numbers",
        "no random numbers",
        "torch.rand",
    ),
    "like a signal": ("", "p.b * torch.randn_like(x.speed)", "`randn_like` draws", "no random numbers", "torch.rand"),
    "without effect here": ("", "0.0 * torch.rand(()) * x.speed", "`rand` draws", "no random numbers", "torch.rand"),
    "of a difference": (
        "",
        "p.b * random.random() * (x.speed - u.voltage)",
        "give other values",
        "no random numbers",
        "class",
    ),
}


def motor(folder: Path, machines: Path, before: str, rate: str) -> str:
    text = "import random\n\nimport torch\n" + (machines / "motor.py").read_text()
    assert text.count(RATE) == text.count(RETURN) == 1
    text = text.replace(RETURN, f"{before}\n        {RETURN}".lstrip()).replace(RATE, rate)
    (folder / "motor.py").write_text(text)
    return text


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_told_at_its_line(tmp_path: Path, machines: Path, fault: str) -> None:
    """Seen: "m.py, line 5: m.py, line 21: ...", and random numbers that cancelled, as every state had the same value."""
    before, rate, found, write, line = FAULTS[fault]
    text = motor(tmp_path, machines, before, rate)
    (finding,) = examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings
    assert finding.level == "error"
    assert finding.found.startswith(found) or (found == "give other values" and found in finding.found)
    assert write in finding.write
    assert finding.line == next(k for k, one in enumerate(text.splitlines(), 1) if line in one)


@pytest.mark.parametrize(
    ("rate", "write"),
    [
        (
            "sin(x.speed)",
            "torch.sin, with import torch at the top of the file: functions of math and numpy cannot take",
        ),
        ("pi * x.speed", "torch.pi, with import torch at the top of the file"),
        (
            "np.pi * x.speed",
            "functions of torch (import torch), such as torch.sin: those of math and numpy cannot take",
        ),
        ("b * x.speed", "p.b"),
        ("rotor_friction(x.speed)", "`rotor_friction` imported or defined at the top of the file"),
        ("torch.tahn(x.speed)", 'a function of torch (did you mean "tan'),
        ("__import__('no_such_module').f(x.speed)", "a module that is installed here; or functions of torch"),
    ],
)
def test_a_name_that_is_not_there_is_told_with_what_to_write(
    tmp_path: Path, machines: Path, rate: str, write: str
) -> None:
    """Seen: "equations that raise nothing, whatever values the states and inputs have", of a name that was not imported."""
    motor(tmp_path, machines, "", rate)
    (finding,) = examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings
    assert finding.line and write in finding.write


@pytest.mark.parametrize(
    ("before", "rate", "found", "line"),
    [
        ("w = x.speed * 1.0; w[0] = 1.0", "p.b * w", "writes into `w` in place", "w[0]"),
        ("w = x.speed * 1.0; w[0] += 1.0", "p.b * w", "writes into `w` in place", "w[0]"),
        ("w = {}; w['a'] = x.speed", "p.b * w['a'][0]", "IndexError: invalid index of a 0-dim tensor", "w['a'][0]"),
        ("", "p.b * x.speed[..., 0, 0, 0]", "IndexError", "x.speed[..."),
    ],
)
def test_an_element_of_a_signal_is_told_without_torchs_advice_to_take_its_value(
    tmp_path: Path, machines: Path, before: str, rate: str, found: str, line: str
) -> None:
    """Seen: "Use `tensor.item()` in Python or `tensor.item<T>()` in C++", which equations cannot, of `w[0] = 1.0`."""
    text = motor(tmp_path, machines, before, rate)
    (finding,) = examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings
    assert found in finding.found and "item" not in finding.found
    assert ("torch.stack" if "writes" in found else "as it is, without an index" if before else "") in finding.write
    assert finding.line == next(k for k, one in enumerate(text.splitlines(), 1) if line in one)


def test_random_numbers_are_refused_where_the_model_is_loaded(tmp_path: Path, machines: Path) -> None:
    motor(tmp_path, machines, "", "p.b * torch.rand(1) * x.speed")
    with pytest.raises(
        UserError,
        match=r"motor.py, line \d+: `rand` draws random numbers; expected equations of x, u, p and port alone",
    ):
        load_model(f"{tmp_path / 'motor.py'}:Motor")


def test_a_missing_argument_is_told_with_the_signature(tmp_path: Path, machines: Path) -> None:
    text = (machines / "motor.py").read_text().replace("derivative(self, x, u, p, port)", "derivative(self, x, u, p)")
    (tmp_path / "motor.py").write_text(text)
    with pytest.raises(UserError, match=r"but 5 were given; expected def derivative\(self, x, u, p, port\)"):
        load_model(f"{tmp_path / 'motor.py'}:Motor")


@pytest.mark.parametrize(
    "weights",
    [
        'if "net" not in self.__dict__: self.__dict__["net"] = torch.nn.init.constant_(torch.empty(1).uniform_(), 0.5).double()',
        'self.__dict__["net"] = torch.rand(1, generator=torch.Generator().manual_seed(0)).double()',
        'self.__dict__["net"] = torch.nn.functional.scaled_dot_product_attention(*torch.ones(3, 1, 1, 1)).double()[0, 0]',
    ],
    ids=["made once", "a generator of its own", "attention"],
)
def test_what_gives_the_same_at_every_call_draws_no_random_numbers(
    tmp_path: Path, machines: Path, weights: str
) -> None:
    """Seen: a network that is made at the first call, with fixed weights, was refused."""
    motor(tmp_path, machines, weights, f'{RATE} * self.__dict__["net"]')
    load_model(f"{tmp_path / 'motor.py'}:Motor")


def test_what_other_threads_draw_is_theirs(tmp_path: Path, machines: Path) -> None:
    """Seen: one load of nine was refused beside a thread that draws."""

    class Beside(threading.Thread):
        def run(self) -> None:
            torch.rand(10)

    # a thread that draws between the calls, at each of them
    motor(tmp_path, machines, "beside = self.beside(); beside.start(); beside.join()", RATE)
    made = model_class(f"{tmp_path / 'motor.py'}:Motor")
    made.beside = Beside  # type: ignore[attr-defined]
    check_equations(made())


@pytest.mark.parametrize(
    ("written", "told", "write"),
    [
        ("x.mtr / 80", "the equations ask for the state 'mtr' (did you", "a function (x, u, p) of what the model declares"),
        ("None", "returns an object of type NoneType for signals of shape (3,)", "one number for each sample"),
        ("x.motor.mean(0, True)", "returns an object of type Tensor of shape (1,)", "one number for each sample"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_the_function_of_a_port_is_told_with_its_line(
    tmp_path: Path, written: str, told: str, write: str
) -> None:
    """Seen: no line, and a list of torch functions as what to write; `fit` went on, and a diagnosis ended there."""
    lines = [
        "from greybox_torch import *",
        "class Rig(GreyBoxModel):",
        '    states, inputs, outputs = [State("motor", "rad"), State("speed", "rad/s")], [Input("u", "N m")], [Output("motor", "rad")]',
        '    ports = [Coupling("gear",',
        f"        deflection=lambda x, u, p: {written}, rate=lambda x, u, p: x.speed)]",
        "    def derivative(self, x, u, p, port):",
        '        return {"motor": x.speed, "speed": u.u - x.motor - port.gear}',
        "    def output(self, x, u, p):",
        '        return {"motor": x.motor}',
    ]
    (tmp_path / "rig.py").write_text("\n".join(lines))
    (error,) = [f for f in examine(model_class(f"{tmp_path / 'rig.py'}:Rig")).findings if f.level == "error"]
    assert f"port 'gear', deflection: {told}" in error.found
    assert error.line == 5 and error.write == write
    with pytest.raises(UserError, match=r"rig\.py, line 5: port 'gear', deflection"):
        check_equations(load_model(f"{tmp_path / 'rig.py'}:Rig"))
