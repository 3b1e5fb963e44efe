"""Long equations in lines."""

from __future__ import annotations

import ast

import pytest

from greybox_torch.diagnosis.equation_lines import WIDTH, in_lines

WAVES = [f"a_{k} * cos(order * {k} * cart.position) + b_{k} * sin(order * {k} * cart.position)" for k in range(2, 7)]
RIPPLE = "port.cart += a * cos(order * cart.position) + b * sin(order * cart.position) + " + " + ".join(WAVES)
STOP = "where((low - ball > 0) & (k * (low - ball) + c * (-speed) >= 0), k * (low - ball) + c * (-speed), 0)"


def test_six_waves_are_six_lines() -> None:
    """Seen: 420 characters in one line."""
    lines = in_lines(RIPPLE).splitlines()
    assert lines[0] == "port.cart += (" and lines[-1] == ")"
    assert [line.strip().removeprefix("+ ") for line in lines[2:-1]] == WAVES
    assert ast.dump(ast.parse(in_lines(RIPPLE))) == ast.dump(ast.parse(RIPPLE))


@pytest.mark.parametrize(
    "text", [f"port.ball += {STOP}", "the spring sees a - b", "port.a += b - c", "w: " + "x" * WIDTH]
)
def test_what_is_short_or_has_one_term_or_is_no_formula_stays_in_one(text: str) -> None:
    assert in_lines(text) == text


def test_terms_in_brackets_stay_together() -> None:
    assert in_lines(f"port.ball += {STOP} - {STOP}") == f"port.ball += (\n    {STOP}\n    - {STOP}\n)"
