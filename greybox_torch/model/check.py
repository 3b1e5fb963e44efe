"""Trying a model's equations once, so that a mistake in them is reported where it is made."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import torch

from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.ports import Port
from greybox_torch.model.signals import Signals
from greybox_torch.model.stacked import odd_one

NEEDS_A_VALUE = (
    "the model's equations need the value of a signal or parameter (a Python `if`, `float()`, `.item()` or a function of `math` on a "
    "tensor); write torch.where(condition, yes, no) and functions of torch instead, so that all samples can be computed side by side"
)


BATCHES = ((3,), (2, 4))
"""Samples side by side; windows and directions are two dimensions of a batch."""


def check_equations(model: GreyBoxModel) -> None:
    """Evaluates the model's rates and outputs on small batches: zeros, and ones in another shape.

    Raises:
        UserError: a port's signal is no state; ``derivative()`` or ``output()`` raises, branches on a signal, does not return what the
            model declares, changes what it is given, or returns something else the second time.
    """
    _check_ports(model)
    with torch.no_grad():
        values = model.physical()
        for batch, level in zip(BATCHES, (0.0, 1.0), strict=True):
            x, u = (torch.full((len(of), *batch), level, dtype=torch.float64) for of in (model.states, model.inputs))
            p = Signals("parameter", {name: value.expand(batch) for name, value in values.items()})
            for function in (model.rates, model.measured):
                first, second = (_evaluated(model, function, x, u, p) for _ in range(2))
                if first.shape[1:] != batch:
                    raise UserError(
                        _of_odd_shape(model, function, x, u, p)
                        or f"the equations of {model.title} return values of shape {tuple(first.shape[1:])} for signals of shape {batch}; "
                        "expected one number for each sample"
                    )
                if not torch.equal(torch.nan_to_num(first), torch.nan_to_num(second)):
                    raise UserError(
                        f"the equations of {model.title} give other values when they are called again with the same; "
                        "expected equations of x, u, p and port alone: no random numbers, no memory in self"
                    )


def _check_ports(model: GreyBoxModel) -> None:
    """The equations do not read what ports say of themselves; laws that are attached there do, long after."""
    for _, found, expected in unknown_signals(model):
        raise UserError(f"{found}; expected {expected}")


def unknown_signals(model: GreyBoxModel | type[GreyBoxModel]) -> Iterator[tuple[Port, str, str]]:
    """Every port of which a signal names no state, what is found there, and what is expected."""
    states = [state.name for state in model.states]
    for port in model.ports:
        for name, signal in port.signals.items():
            if isinstance(signal, str) and signal not in states:
                found = f"port '{port.name}': {name} = \"{signal}\" is not a state{did_you_mean(signal, states)}"
                yield port, found, f"one of {', '.join(states)}, or {name}=lambda x, u, p: …"


def _evaluated(model: GreyBoxModel, function: Callable[..., torch.Tensor], *given: Any) -> torch.Tensor:
    x, u, p = given
    before = [tensor._version for tensor in (x, u, *p.values())]
    try:
        found = function(x, u, p)
    except UserError:
        raise
    except Exception as error:
        raise UserError(_of_odd_shape(model, function, x, u, p) or explain(model, error)) from None
    if [tensor._version for tensor in (x, u, *p.values())] != before:
        raise UserError(
            f"the equations of {model.title} change the signals that they are given (an operation in place, such as `+=` or `.add_()`); "
            "write a = a + b instead"
        )
    return found


def _of_odd_shape(model: GreyBoxModel, function: Callable[..., Any], x: torch.Tensor, u: torch.Tensor, p: Any) -> str:
    """Which method gives for which name values of another shape than the signals have; "" where that is not so."""
    method = "derivative" if function == model.rates else "output"
    batch = tuple(x.shape[1:])
    forces = Signals("port", {port.name: x.new_zeros(()).expand(batch) for port in model.all_ports})
    given = (*model.named_signals(x, u), p, *([forces] if method == "derivative" or model.asks_for_forces else []))
    try:
        odd = odd_one(getattr(model, method)(*given), batch)
    except Exception:  # what they raise is told elsewhere
        return ""
    return (
        ""
        if odd is None
        else (
            f"{model.title}.{method}() returned '{odd[0]}' of shape {odd[1]} for signals of shape {batch}; "
            "expected one number for each sample"
        )
    )


def explain(model: GreyBoxModel, error: Exception) -> str:
    """In words, what went wrong in the equations of ``model`` and in which line of which file."""
    place = _place(model, error)
    if any(words in str(error) for words in ("Boolean value of Tensor", "to Scalar", "to Python scalar")):
        return f"{place}{NEEDS_A_VALUE}"
    hint = "; use functions of torch instead" if "numpy" in str(error) else ""
    return f"{place}the equations of {model.title} raised {type(error).__name__}: {error}{hint}"


def line_of(model: GreyBoxModel, error: BaseException) -> int | None:
    """The last line on the way to the error that is in a file of the model's equations."""
    frame = _frame(model, error)
    return None if frame is None else frame.lineno


def _place(model: GreyBoxModel, error: BaseException) -> str:
    frame = _frame(model, error)
    return f"{Path(frame.filename).name}, line {frame.lineno}: " if frame else ""


def _frame(model: GreyBoxModel, error: BaseException) -> traceback.FrameSummary | None:
    files = {
        code.co_filename
        for m in ("derivative", "output")
        if (code := getattr(getattr(type(model), m), "__code__", None))
    }
    return next((f for f in reversed(traceback.extract_tb(error.__traceback__)) if f.filename in files), None)
