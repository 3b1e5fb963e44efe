"""Torch in Python for expression graphs; every value is a tensor of the batch, or a number."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.exporting.statements import with_sign

_LOGIC = {"and": "&", "or": "|"}
_CALLED = {"min": "minimum", "max": "maximum"}


class Torch:
    """See :class:`greybox_torch.exporting.statements.Language`."""

    def constant(self, value: float) -> str:
        return f"c({value!r})" if abs(value) != float("inf") else f'c(float("{value}"))'

    def leaf(self, kind: str, index: int) -> str:
        return f"{kind}[..., {index}]"

    def operation(self, name: str, arguments: Sequence[str]) -> str:
        called = f"torch.{_CALLED.get(name, name)}({', '.join(arguments)})"
        return with_sign(name, arguments, _LOGIC, "~") or called

    def as_number(self, condition: str) -> str:
        return f"{condition}.to(x.dtype)"

    def as_condition(self, number: str) -> str:
        return f"({number} != 0)"

    def declaration(self, name: str, is_condition: bool, value: str) -> str:
        return f"        {name} = {value}"
