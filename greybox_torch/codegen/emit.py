"""C++ source for a model's stepper: Runge-Kutta 4 with forward sensitivities, many windows side by side in vector lanes.

Every scalar of the model becomes a vector of lanes, one lane a window: with AVX-512 these are 8 double precision numbers, else 4, and in
single precision twice as many. Terms that depend on parameters alone are computed once. Within a step the four stages of the states come
first, with their sparse Jacobians; then each tangent direction goes through all four in one product.
"""

from __future__ import annotations

from collections.abc import Iterable

from greybox_torch.codegen.derive import Partials
from greybox_torch.codegen.expression import ARITHMETIC, BOOLEAN, COMPARISONS, FUNCTIONS, LOGIC
from greybox_torch.codegen.lower import Equations
from greybox_torch.codegen.tangents import Entry, Transition, added, scaled
from greybox_torch.codegen.template import PROGRAM


def emit(equations: Equations, precision: str) -> str:
    """The complete C++ source for ``equations`` in ``"double"`` or ``"float"``."""
    body = _Body(equations)
    n_x, n_y, n_p = equations.n_states, equations.n_outputs, len(equations.sensitive)
    rate_rows = [(f"dx[{i}]", node) for i, node in enumerate(equations.rates)]
    n_t = equations.n_tangent
    state_entries = _entries(equations.rates_by_state[:n_t])
    output_rows = [(f"y[{i}]", node) for i, node in enumerate(equations.outputs)]
    output_states = _entries(equations.outputs_by_state)
    output_parameters = _entries(equations.outputs_by_parameter)
    column = {equations.graph.leaf("p", p): k for k, p in enumerate(equations.sensitive)}
    parameter_entries = sorted(_entries(equations.rates_by_parameter[:n_t]), key=lambda entry: column[entry[1]])
    row_of_state = {equations.graph.leaf("x", i): i for i in range(n_x)}
    transition = _transition(n_t, state_entries, row_of_state, body)

    stored_a = [(f"A[{k}]", node) for k, (_, _, node) in enumerate(state_entries)]
    stored_b = [(f"B[{k}][0]", node) for k, (_, _, node) in enumerate(parameter_entries)]
    stored_c = [(f"C[{k}]", node) for k, (_, _, node) in enumerate(output_states)]
    stored_d = [(f"D[{column[leaf]}][{i}]", node) for i, leaf, node in output_parameters]
    functions = {
        "RATES": body.statements(rate_rows),
        "RATES_JACOBIAN": body.statements(rate_rows + stored_a + stored_b),
        "OUTPUTS": body.statements(output_rows),
        "OUTPUTS_JACOBIAN": body.statements(output_rows + stored_c + stored_d),
        "TRANSITION": transition.matrices(),
        "PROPAGATE": transition.propagation(),
        "TANGENT_OUTPUT": _tangent_output(n_y, output_states, row_of_state, body),
        **_forced_rows([(i, column[leaf]) for i, leaf, _ in parameter_entries], n_p),
    }
    text = PROGRAM
    for name, code in {**functions, "PROLOGUE": body.prologue()}.items():
        text = text.replace(f"/*{name}*/", code)
    sizes = {
        "NX": n_x,
        "NT": n_t,
        "NU": max(equations.n_inputs, 1),
        "NY": n_y,
        "NP": max(equations.n_parameters, 1),
        "NS": n_p,
        "NA": max(len(state_entries), 1),
        "NB": max(len(parameter_entries), 1),
        "NC": max(len(output_states), 1),
        "NH": max(body.hoisted_count, 1),
    }
    header = "".join(f"#define {name} {value}\n" for name, value in sizes.items())
    real = "double" if precision == "double" else "float"
    return f"typedef {real} real;\n{header}{text}"


def _entries(rows: list[Partials]) -> list[tuple[int, int, int]]:
    return [(i, leaf, node) for i, row in enumerate(rows) for leaf, node in sorted(row.items())]


class _Body:
    """Turns nodes into statements; nodes that depend on parameters alone go to a prologue, run once per call."""

    def __init__(self, equations: Equations) -> None:
        self.graph = equations.graph
        self._hoisted: dict[str, int] = {}
        self._prologue_roots: list[tuple[int, int]] = []

    @property
    def hoisted_count(self) -> int:
        return len(self._hoisted)

    def statements(self, targets: Iterable[tuple[str, int]]) -> str:
        """Assignments to ``targets``, each right after what it needs: the fewer values wait, the faster the program is compiled."""
        varies = self.graph.depends_on(frozenset({"x", "u"}))
        lines: list[str] = []
        written: set[int] = set()
        for target, root in targets:
            for index in self.graph.needed([root], written):
                node = self.graph.nodes[index]
                written.add(index)
                if node.operation not in ("constant", "leaf") and varies[index]:
                    lines.append(f"{self._type(index)} t{index} = {self._expression(index, varies)};")
            lines.append(f"{target} = {self._number(root, varies)};")
        return "\n".join(lines)

    def prologue(self) -> str:
        """Statements that fill ``h``, the values that depend on parameters alone."""
        nothing = [True] * len(self.graph.nodes)
        lines = []
        for index in self.graph.needed(node for node, _ in self._prologue_roots):
            node = self.graph.nodes[index]
            if node.operation not in ("constant", "leaf"):
                lines.append(f"{self._type(index)} t{index} = {self._expression(index, nothing)};")
        for key, slot in self._hoisted.items():
            kind, node = key.split(":")
            value = self._number(int(node), nothing)
            lines.append(f"h[{slot}] = {f'splat(1)/{value}' if kind == 'inverse' else value};")
        return "\n".join(lines)

    def is_constant(self, index: int) -> float | None:
        return self.graph.value_of(index)

    def _type(self, index: int) -> str:
        return "mask" if self.graph.nodes[index].operation in BOOLEAN else "vec"

    def _hoist(self, kind: str, index: int) -> str:
        key = f"{kind}:{index}"
        if key not in self._hoisted:
            self._hoisted[key] = len(self._hoisted)
            self._prologue_roots.append((index, self._hoisted[key]))
        return f"h[{self._hoisted[key]}]"

    def _reference(self, index: int, varies: list[bool]) -> str:
        node = self.graph.nodes[index]
        if node.operation == "constant":
            return (
                f"splat({node.value!r})"
                if abs(node.value) != float("inf")
                else f"splat({'-' * (node.value < 0)}__builtin_inf())"
            )
        if node.operation == "leaf":
            return f"{node.leaf}[{int(node.value)}]"
        return f"t{index}" if self._varies(index, varies) else self._hoist("value", index)

    def _varies(self, index: int, varies: list[bool]) -> bool:
        return index >= len(varies) or varies[index]

    def _number(self, index: int, varies: list[bool]) -> str:
        """A node as a vector of numbers: a condition counts as one where it holds and zero where not."""
        text = self._reference(index, varies)
        is_mask = self._type(index) == "mask" and self._varies(index, varies)
        return f"choose({text}, splat(1), splat(0))" if is_mask else text

    def _condition(self, index: int, varies: list[bool]) -> str:
        """A node as a condition, which holds where it is not zero. (What the prologue keeps are numbers.)"""
        text = self._reference(index, varies)
        is_mask = self._type(index) == "mask" and self._varies(index, varies)
        return text if is_mask else f"({text} != splat(0))"

    def _expression(self, index: int, varies: list[bool]) -> str:
        node = self.graph.nodes[index]
        if node.operation == "div" and not all(varies):
            numerator, denominator = node.arguments
            if not varies[denominator] and self.graph.value_of(denominator) is None:
                return f"{self._number(numerator, varies)} * {self._hoist('inverse', denominator)}"
        operation = node.operation
        if operation in LOGIC or operation == "not":
            conditions = [self._condition(a, varies) for a in node.arguments]
            return f"~{conditions[0]}" if operation == "not" else f"{conditions[0]} {LOGIC[operation]} {conditions[1]}"
        arguments = [self._number(a, varies) for a in node.arguments]
        table = {**ARITHMETIC, **COMPARISONS}
        if operation in table:
            return f"{arguments[0]} {table[operation]} {arguments[1]}"
        if operation == "neg":
            return f"-{arguments[0]}"
        if operation == "where":
            return f"choose({self._condition(node.arguments[0], varies)}, {arguments[1]}, {arguments[2]})"
        if operation in FUNCTIONS or operation in ("min", "max", "pow", "atan2"):
            return f"v_{operation}({', '.join(arguments)})"
        raise AssertionError(f"no C++ form of '{operation}'")


def _tangent_output(n_y: int, entries: list[tuple[int, int, int]], row_of_state: dict[int, int], body: _Body) -> str:
    """Statements of ``s = C · z + d`` with the sparse matrix C whose constant entries are written out."""
    lines = []
    for row in range(n_y):
        of_row = [(k, leaf, node) for k, (i, leaf, node) in enumerate(entries) if i == row]
        terms = [scaled(f"z[{row_of_state[leaf]}]", f"C[{k}]", body.is_constant(node)) for k, leaf, node in of_row]
        lines.append(f"s[{row}] = {added([f'd[{row}]', *terms])};")
    return "\n".join(lines)


def _transition(n_t: int, entries: list[tuple[int, int, int]], row_of_state: dict[int, int], body: _Body) -> Transition:
    """How tangents go through a step, ``entries`` those of the Jacobian by the states that tangents are of."""
    columns = ((k, i, row_of_state[leaf], node) for k, (i, leaf, node) in enumerate(entries))
    return Transition.of(n_t, {(i, j): Entry(k, body.is_constant(node)) for k, i, j, node in columns if j < n_t})


def _forced_rows(entries: list[tuple[int, int]], n_p: int) -> dict[str, str]:
    """Of entries (row, parameter) in the order of parameters: where those of each begin, with one more for none, and their rows."""
    first = [sum(parameter < k for _, parameter in entries) for k in range(n_p + 1)]
    return {"FIRST_ROWS": _listed([*first, first[-1]]), "ROWS": _listed([i for i, _ in entries] or [0])}


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers))
