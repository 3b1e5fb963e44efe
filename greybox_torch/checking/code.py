"""Code in the equations that cannot be computed for many samples side by side, differentiated or compiled, and what to write instead.

A value is taken for a signal where it is made from the arguments of ``derivative`` or ``output``. That is a reading of the text, not a
proof: what is found here counts only where running the equations fails as well (:mod:`greybox_torch.checking.equations`).
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Method

_OF_VALUES = {"float", "int", "bool", "complex", "round"}
_BUILT_IN = {
    "max": "torch.maximum(a, b), or a.clamp(min=…)",
    "min": "torch.minimum(a, b), or a.clamp(max=…)",
}
_LIBRARIES = {"np", "numpy", "math", "scipy", "sp", "cmath"}
_NOT_SIGNALS = {"shape", "dtype", "device", "ndim", "requires_grad"}
_QUESTIONS = {"isinstance", "hasattr", "len", "callable", "type"}


def untraceable(method: Method) -> Iterator[Finding]:
    """Findings with the line of each."""
    reader = _Reader(method)
    reader.visit(method.tree)
    yield from reader.findings


class _Reader(ast.NodeVisitor):
    def __init__(self, method: Method) -> None:
        self.method = method
        self.signals = set(method.arguments)
        self.findings: list[Finding] = []

    def visit_Assign(self, node: ast.Assign) -> None:
        for target in node.targets:
            self._write_into(target, node)
        if self._is_signal(node.value):
            for target in node.targets:
                names = [n.id for n in ast.walk(target) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
                self.signals.update(names)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._write_into(node.target, node)
        if isinstance(node.target, ast.Name) and self._is_signal(node.value):
            self.signals.add(node.target.id)
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        self._branch(node.test, "an `if` on a signal", node)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        self._branch(node.test, "`a if condition else b` on a signal", node)
        self.generic_visit(node)

    def visit_While(self, node: ast.While) -> None:
        self._branch(node.test, "a `while` on a signal", node, "a fixed number of steps")
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        if any(self._is_signal(value) for value in node.values):
            word, sign = ("and", "&") if isinstance(node.op, ast.And) else ("or", "|")
            self._say(f"`{word}` between conditions on signals", f"(a) {sign} (b), each in brackets", node)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not) and self._is_signal(node.operand):
            self._say("`not` on a signal", "~(condition)", node)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        if len(node.ops) > 1 and self._is_signal(node):
            self._say("a chain of comparisons on signals", "(a < x) & (x < b)", node)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        if any(self._is_signal(argument) for argument in node.args):
            self._call_of_function(node)
        if isinstance(node.func, ast.Attribute) and self._is_signal(node.func.value):
            if node.func.attr in ("item", "tolist"):
                self._say(f"`.{node.func.attr}()` takes the value of a signal", "the signal itself, as a tensor", node)
            if node.func.attr in ("numpy", "detach"):
                self._say(f"`.{node.func.attr}()` cuts the gradient", "the signal itself, as a tensor", node)
        self.generic_visit(node)

    def _call_of_function(self, node: ast.Call) -> None:
        function = node.func
        if isinstance(function, ast.Name) and function.id in _OF_VALUES:
            self._say(f"`{function.id}()` takes the value of a signal", "the signal itself, as a tensor", node)
        elif isinstance(function, ast.Name) and function.id in _BUILT_IN:
            self._say(f"Python's `{function.id}` on signals", _BUILT_IN[function.id], node)
        elif isinstance(function, ast.Attribute):
            root = function.value
            while isinstance(root, ast.Attribute):
                root = root.value
            if isinstance(root, ast.Name) and root.id in _LIBRARIES:
                self._say(f"`{ast.unparse(function)}` on a signal", f"torch.{function.attr}(…)", node)

    def _branch(self, test: ast.expr, what: str, node: ast.AST, instead: str = "") -> None:
        if self._is_signal(test):
            self._say(what, instead or "torch.where(condition, yes, no)", node)

    def _write_into(self, target: ast.expr, node: ast.Assign | ast.AugAssign) -> None:
        if isinstance(target, ast.Subscript) and (self._is_signal(node.value) or self._is_signal(target.value)):
            if isinstance(target.slice, ast.Constant) and isinstance(target.slice.value, str):
                return  # a dictionary is written into, not a signal
            self._say(
                f"writes into `{ast.unparse(target.value)}` in place",
                "torch.stack([…]) of the elements; a matrix is torch.stack([torch.stack([…], -1), …], -2)",
                node,
            )
        if isinstance(target, ast.Attribute) and self._is_signal(target.value):
            self._say(f"changes `{ast.unparse(target)}`", "a name of your own for the new value", node)

    def _is_signal(self, node: ast.AST) -> bool:
        """Whether the value of an expression is made from signals."""
        if isinstance(node, ast.Name):
            return node.id in self.signals
        if isinstance(node, ast.Attribute) and node.attr in _NOT_SIGNALS:
            return False
        if isinstance(node, ast.Compare) and all(
            isinstance(op, ast.Is | ast.IsNot | ast.In | ast.NotIn) for op in node.ops
        ):
            return False
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _QUESTIONS:
            return False
        return any(self._is_signal(child) for child in ast.iter_child_nodes(node))

    def _say(self, found: str, write: str, node: ast.AST) -> None:
        line = getattr(node, "lineno", None)
        self.findings.append(Finding("error", "code", found, write, self.method.file, line))
