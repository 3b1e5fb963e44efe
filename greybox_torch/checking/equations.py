"""Running the equations: that they give what is declared, the same each time, sample by sample; and whether they can be compiled."""

from __future__ import annotations

from collections.abc import Iterator

import torch

from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import Traced, traced
from greybox_torch.codegen.arrays import UnsupportedOperation
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.check import check_equations, explain, line_of

_INSTEAD = {
    "linalg_inv_ex": "torch.linalg.solve(matrix, right_hand_side)",
    "_linalg_det": "the determinant written out",
    "copy": "torch.stack([…]) instead of writing into a matrix",
    "index_put": "torch.stack([…]) instead of writing into a matrix",
    "einsum": "matrix @ vector, or the sums written out",
}
_COMPILED = "+ - * / **, torch.where, sin, cos, tanh, exp, sqrt, abs, sign, minimum, maximum, clamp, stack, @, torch.linalg.solve"


def fails(model: GreyBoxModel, source: Source) -> Iterator[Finding]:
    """A finding where the equations raise, or do not return what is declared."""
    try:
        check_equations(model)
        _in_other_shapes(model)
    except UserError as error:
        yield Finding("error", "code", str(error), "equations that give one number a sample", source.file)


def changes(model: GreyBoxModel, source: Source) -> Iterator[Finding]:
    """A finding where the same values give other rates or outputs the second time."""
    draw = torch.Generator().manual_seed(0)
    x, u = (torch.randn(len(of), 3, generator=draw, dtype=torch.float64) for of in (model.states, model.inputs))
    with torch.no_grad():
        p = model.physical()
        first, second = (torch.cat([model.rates(x, u, p), model.measured(x, u, p)]) for _ in range(2))
    if not torch.equal(torch.nan_to_num(first), torch.nan_to_num(second)):
        found = "the equations give other values when they are called again with the same"
        write = "equations of x, u, p and port alone: no random numbers, no memory in self"
        yield Finding("error", "code", found, write, source.file, source.line)


def compiled(model: GreyBoxModel, source: Source) -> tuple[Traced | None, list[Finding]]:
    """The equations as an expression graph, or why there is none."""
    try:
        return traced(model, source.file), []
    except UnsupportedOperation as error:
        operation = str(error).split("'")[1].removeprefix("aten::") if "'" in str(error) else str(error)
        instead = _INSTEAD.get(operation, f"what is compiled: {_COMPILED}")
        found = (
            f"{error} has no compiled form: simulation takes a hundred times as long, and a diagnosis is out of reach"
        )
        return None, [Finding("warning", "code", found, instead, source.file, line_of(model, error))]
    except UserError as error:
        return None, [Finding("error", "code", str(error), f"functions of torch: {_COMPILED}", source.file)]
    except Exception as error:  # whatever the user's equations raise when they are handed symbols
        return None, [Finding("error", "code", explain(model, error), f"functions of torch: {_COMPILED}", source.file)]


def _in_other_shapes(model: GreyBoxModel) -> None:
    """Windows and directions are two dimensions of a batch. Raises UserError where the equations do not keep them apart."""
    batch = (2, 3)
    x = torch.ones(len(model.states), *batch, dtype=torch.float64)
    u = torch.ones(len(model.inputs), *batch, dtype=torch.float64)
    with torch.no_grad():
        p = Signals("parameter", {name: value.expand(batch) for name, value in model.physical().items()})
        for function in (model.rates, model.measured):
            try:
                shape = tuple(function(x, u, p).shape[1:])
            except UserError:
                raise
            except Exception as error:
                raise UserError(explain(model, error)) from None
            if shape != batch:
                raise UserError(f"the equations return values of shape {shape} for signals of shape {batch}")
