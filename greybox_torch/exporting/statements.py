"""An expression graph as statements of a language, one a node."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from greybox_torch.codegen.expression import ARITHMETIC, BOOLEAN, COMPARISONS, Graph


class Language(Protocol):
    """How a language writes numbers, variables, operations and assignments."""

    def constant(self, value: float) -> str: ...

    def leaf(self, kind: str, index: int) -> str: ...

    def operation(self, name: str, arguments: Sequence[str]) -> str: ...

    def as_number(self, condition: str) -> str: ...

    def as_condition(self, number: str) -> str: ...

    def declaration(self, name: str, is_condition: bool, value: str) -> str: ...


def with_sign(name: str, arguments: Sequence[str], logic: Mapping[str, str], negation: str) -> str | None:
    """An operation that is written with a sign between its arguments or before it; None where it is written otherwise.

    Args:
        logic: the language's signs for "and" and "or"; ``negation`` its sign for "not".
    """
    between = {**ARITHMETIC, **COMPARISONS, **logic}
    if name in between:
        return f"{arguments[0]} {between[name]} {arguments[1]}"
    before = {"neg": "-", "not": negation}
    return f"{before[name]}{arguments[0]}" if name in before else None


def statements(graph: Graph, roots: Sequence[int], language: Language) -> tuple[list[str], list[str]]:
    """The statements that compute ``roots``, and what each root is then called."""
    written: dict[int, str] = {}
    lines: list[str] = []
    is_condition = [node.operation in BOOLEAN for node in graph.nodes]

    def number(index: int) -> str:
        return language.as_number(written[index]) if is_condition[index] else written[index]

    def condition(index: int) -> str:
        return written[index] if is_condition[index] else language.as_condition(written[index])

    for index in graph.needed(roots):
        node = graph.nodes[index]
        if node.operation == "constant":
            written[index] = language.constant(node.value)
        elif node.operation == "leaf":
            written[index] = language.leaf(node.leaf, int(node.value))
        else:
            logical = node.operation in ("and", "or", "not")
            arguments = [
                condition(a) if logical or (node.operation == "where" and k == 0) else number(a)
                for k, a in enumerate(node.arguments)
            ]
            value = language.operation(node.operation, arguments)
            written[index] = f"t{index}"
            lines.append(language.declaration(f"t{index}", is_condition[index], value))
    return lines, [number(root) for root in roots]
