"""Nodes as text that Python reads as the same expression."""

from __future__ import annotations

import pytest
import torch

from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.formula import formula
from greybox_torch.codegen.trace import nodes_of, separate_symbols

LAWS = {
    "-a * tanh(b / c)": lambda a, b, c: -a * torch.tanh(b / c),
    "a - (b - c)": lambda a, b, c: a - (b - c),
    "a / (b * c)": lambda a, b, c: a / (b * c),
    "(a + b) * (-c)": lambda a, b, c: (a + b) * -c,
    "a - (-b)": lambda a, b, c: a - -b,
    "exp(-(a / b) ** 2) + c ** 3": lambda a, b, c: torch.exp(-((a / b) ** 2)) + c**3,
    "where((a > b) & (c >= 0), a, -2)": lambda a, b, c: torch.where((a > b) & (c >= 0), a, -2.0),
}


@pytest.mark.parametrize("text", LAWS)
def test_a_formula_is_what_python_would_compute(text: str) -> None:
    graph = Graph()
    root = nodes_of(graph, LAWS[text](*separate_symbols(graph, "x", 3)).reshape(1))[0]
    assert formula(graph, root, lambda kind, place: "abc"[place]) == text
    values = dict(zip("abc", torch.tensor([0.7, -1.3, 2.1], dtype=torch.float64), strict=True))
    known = {"tanh": torch.tanh, "exp": torch.exp, "where": torch.where, **values}
    assert float(eval(text, known)) == pytest.approx(float(LAWS[text](*values.values())))


def test_what_is_deep_is_left_out() -> None:
    graph = Graph()
    a, b, c = separate_symbols(graph, "x", 3)
    root = nodes_of(graph, (a + b * torch.sin(c)).reshape(1))[0]
    assert formula(graph, root, lambda kind, place: "abc"[place], 2) == "a + b * …"
