"""A long equation in lines that can be read."""

from __future__ import annotations

import re

WIDTH = 100
"""Characters of a line up to which terms stand side by side: two waves of a ripple with a long name of its signal."""


def in_lines(equation: str) -> str:
    """An equation ``place += terms`` with brackets around its terms and lines of whole ones, as Python takes it; a short one as it is.

    Examples:
        >>> in_lines("port.cart += -F_c * tanh(v / v_0)")
        'port.cart += -F_c * tanh(v / v_0)'
    """
    place, sign, right = equation.partition(" += ")
    terms = _terms(right)
    if not sign or len(equation) <= WIDTH or len(terms) < 2:
        return equation
    lines = [terms[0]]
    for term in terms[1:]:
        longer = f"{lines[-1]} {term}"
        lines[-1:] = [longer] if len(longer) < WIDTH else [lines[-1], term]
    return "\n    ".join([f"{place} += (", *lines]) + "\n)"


def _terms(text: str) -> list[str]:
    """What is added or subtracted outside of all brackets, each with its sign but the first."""
    terms, depth, begun = [], 0, 0
    for found in re.finditer(r"[()]| [+-] ", text):
        if found.group() in "()":
            depth += 1 if found.group() == "(" else -1
        elif depth == 0:
            terms.append(text[begun : found.start()])
            begun = found.start() + 1
    return [*terms, text[begun:]]
