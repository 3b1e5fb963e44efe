"""Equations whose arguments stand at other places than usual: one finding, and none on every name in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.checking.examine import examine
from greybox_torch.systems import model_class

DERIVATIVE, OUTPUT = "derivative(self, x, u, p, port)", "output(self, x, u, p)"


@pytest.mark.parametrize(
    ("usual", "written"),
    [
        (DERIVATIVE, "derivative(x, u, p, port)"),
        (DERIVATIVE, "derivative(self, t, x, u, p)"),
        (OUTPUT, "output(x, u, p)"),
        (OUTPUT, "output(self, u, x, p)"),
        (DERIVATIVE, "derivative(self, x, u, p)"),
        (DERIVATIVE, "derivative(self, x, u, p, port, t)"),
        (OUTPUT, "output(self, x, u)"),
    ],
)
def test_arguments_in_another_order_or_number_are_one_finding(
    machines: Path, tmp_path: Path, usual: str, written: str
) -> None:
    """Seen: eight errors on undeclared names, and none on the missing `self`."""
    text = (machines / "motor.py").read_text()
    assert text.count(usual) == 1
    (tmp_path / "motor.py").write_text(text.replace(usual, written))
    (finding,) = examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings
    assert (finding.level, finding.found) == ("error", f"{written}: expected {usual}, in this order")
    assert finding.line is not None and written in (tmp_path / "motor.py").read_text().splitlines()[finding.line - 1]


@pytest.mark.parametrize(
    "written",
    [
        "derivative(self, x, u, p, port, gain=1.0)",
        "derivative(self, x, u, *rest)",
        "output(self, x, u, p, *, gain=1.0)",
    ],
)
def test_arguments_that_are_not_handed_are_fine(machines: Path, tmp_path: Path, written: str) -> None:
    usual = DERIVATIVE if written.startswith("derivative") else OUTPUT
    text = (machines / "motor.py").read_text().replace(usual, written)
    text = (
        text.replace("        return {", "        p, port = rest\n        return {", 1) if "*rest" in written else text
    )
    (tmp_path / "motor.py").write_text(text)
    assert examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings == ()


def test_other_names_of_arguments_are_fine(machines: Path, tmp_path: Path) -> None:
    text = (machines / "motor.py").read_text()
    (tmp_path / "motor.py").write_text(
        text.replace(OUTPUT, "output(self, state, u, p)").replace('"speed": x.', '"speed": state.')
    )
    assert examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings == ()


def test_a_name_that_is_no_attribute_is_read_by_its_text(machines: Path, tmp_path: Path) -> None:
    """Seen: `u.su n` to be written, below the line that says that this is no Python."""
    text = (machines / "motor.py").read_text()
    inputs = 'inputs = [Input("su n", "V"), '
    assert text.count("inputs = [") == 1
    (tmp_path / "motor.py").write_text(text.replace("inputs = [", inputs))
    found = examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings
    (one,) = [f for f in found if f.found.startswith("input 'su n' moves no output")]
    assert one.write.startswith('u["su n"] in derivative() or output()')


def test_an_input_that_the_equations_leave_out_may_stay_for_a_diagnosis(machines: Path, tmp_path: Path) -> None:
    """Seen: "write: u.wind" of the wind that the diagnosis then found to cool a greenhouse, as it was recorded and not used."""
    text = (machines / "motor.py").read_text()
    (tmp_path / "motor.py").write_text(text.replace("inputs = [", 'inputs = [Input("wind", "m/s"), '))
    (found,) = examine(model_class(f"{tmp_path / 'motor.py'}:Motor")).findings
    assert found.write == (
        "u.wind in derivative() or output(); or nothing, if diagnose or train is to find what it does at rotor"
    )
