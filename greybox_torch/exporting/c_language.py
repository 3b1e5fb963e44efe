"""Scalar C (C99) for expression graphs."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.exporting.statements import with_sign

_LOGIC = {"and": "&&", "or": "||"}
_HELPERS = {
    "sign": "static double sign(double a) { return (a > 0.0) - (a < 0.0); }",
    "minimum": "static double minimum(double a, double b) { return a < b ? a : b; }",
    "maximum": "static double maximum(double a, double b) { return a > b ? a : b; }",
}
_CALLED = {"abs": "fabs", "min": "minimum", "max": "maximum"}


class C:
    """See :class:`greybox_torch.exporting.statements.Language`; ``helpers`` are the functions that what was written calls."""

    def __init__(self) -> None:
        self._used: set[str] = set()

    @property
    def helpers(self) -> list[str]:
        return [text for name, text in _HELPERS.items() if name in self._used]

    def constant(self, value: float) -> str:
        if abs(value) == float("inf"):
            return "HUGE_VAL" if value > 0 else "(-HUGE_VAL)"
        return repr(value) if value >= 0 else f"({value!r})"

    def leaf(self, kind: str, index: int) -> str:
        return f"{kind}[{index}]"

    def operation(self, name: str, arguments: Sequence[str]) -> str:
        written = with_sign(name, arguments, _LOGIC, "!")
        if written is not None:
            return written
        if name == "where":
            return f"{arguments[0]} ? {arguments[1]} : {arguments[2]}"
        called = _CALLED.get(name, name)
        self._used.add(called)
        return f"{called}({', '.join(arguments)})"

    def as_number(self, condition: str) -> str:
        return f"({condition} ? 1.0 : 0.0)"

    def as_condition(self, number: str) -> str:
        return f"({number} != 0.0)"

    def declaration(self, name: str, is_condition: bool, value: str) -> str:
        return f"    const {'int' if is_condition else 'double'} {name} = {value};"
