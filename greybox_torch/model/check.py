"""Trying a model's equations once, so that a mistake in them is reported where it is made."""

from __future__ import annotations

import inspect
import re
import traceback
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from numbers import Real
from pathlib import Path
from typing import Any

import torch

from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.missing_names import advice_for
from greybox_torch.model.ports import Port, value_of
from greybox_torch.model.random_numbers import Draw, watched
from greybox_torch.model.signals import Signals
from greybox_torch.model.stacked import odd_one

NEEDS_A_VALUE = (
    "the model's equations need the value of a signal or parameter (a Python `if`, `float()`, `.item()` or a function of `math` on a "
    "tensor); write torch.where(condition, yes, no) and functions of torch instead, so that all samples can be computed side by side"
)
_ADVICE_OF_TORCH = re.compile(r"\s*Use `?tensor\.(item|detach|cpu|numpy)\b.*", re.DOTALL)
"""A sentence to the end: it takes the value of a signal, which equations cannot."""

BATCHES = ((3,), (2, 4))
"""Samples side by side; windows and directions are two dimensions of a batch."""

ALONE = "expected equations of x, u, p and port alone: no random numbers, no memory in self"


class EquationsError(UserError):
    """What is wrong with a model's equations: ``found`` without its place, and the ``file`` and ``line`` of that place, if it is known."""

    def __init__(self, found: str, place: tuple[str, int | None] | None = None) -> None:
        file, line = place or (None, None)
        super().__init__(f"{Path(file).name}, line {line}: {found}" if file else found)
        self.found, self.file, self.line = found, file, line


def check_equations(model: GreyBoxModel) -> None:
    """Evaluates the model's rates and outputs on small batches: zeros, and in another shape values that differ from signal to signal.

    Raises:
        UserError: a port's signal is no state; ``derivative()`` or ``output()`` raises, branches on a signal, does not return what the
            model declares, changes what it is given, or returns something else the second time.
    """
    _check_ports(model)
    files = _files(model)
    with torch.no_grad():
        values = model.physical()
        _check_functions_of_ports(model, values)
        for batch, level in zip(BATCHES, (0.0, 1.0), strict=True):
            x, u = _signals(model, batch, level)
            p = Signals("parameter", {name: value.expand(batch) for name, value in values.items()})
            for function in (model.rates, model.measured):
                first = _evaluated(model, function, x, u, p)
                # the second call alone: what is made once, such as a network, may draw the values that it begins with
                second, draw = watched(partial(_evaluated, model, function, x, u, p), files)
                if draw is not None:
                    raise _random(model, draw)
                if first.shape[1:] != batch:
                    raise UserError(
                        _of_odd_shape(model, function, x, u, p)
                        or f"the equations of {model.title} return values of shape {tuple(first.shape[1:])} for signals of shape {batch}; "
                        "expected one number for each sample"
                    )
                if not torch.equal(torch.nan_to_num(first), torch.nan_to_num(second)):
                    raise UserError(
                        f"the equations of {model.title} give other values when they are called again with the same; {ALONE}"
                    )


def _signals(model: GreyBoxModel, batch: tuple[int, ...], level: float) -> tuple[torch.Tensor, torch.Tensor]:
    """States and inputs around ``level``, no two the same unless it is zero: in a difference of equal ones mistakes cancel."""
    count = len(model.states) + len(model.inputs)
    values = level * (1.0 + 0.1 * torch.arange(count, dtype=torch.float64))
    rows = values.reshape(-1, *[1] * len(batch)) * torch.ones(batch, dtype=torch.float64)
    return rows[: len(model.states)].clone(), rows[len(model.states) :].clone()


def _check_ports(model: GreyBoxModel) -> None:
    """The equations do not read what ports say of themselves; laws that are attached there do, long after."""
    for _, found, expected in unknown_signals(model):
        raise UserError(f"{found}; expected {expected}")


def _check_functions_of_ports(model: GreyBoxModel, values: Mapping[str, torch.Tensor]) -> None:
    """That the functions which ports have as signals can be called with the model's names."""
    x, u = model.named_signals(*_signals(model, BATCHES[0], 1.0))
    p = Signals("parameter", {name: value.expand(BATCHES[0]) for name, value in values.items()})
    for port in model.ports:
        for name, signal in port.signals.items():
            place = f"port '{port.name}', {name}"
            try:
                value = value_of(signal, x, u, p)
            except Exception as error:
                said = str(error) if isinstance(error, UserError) else f"raised {type(error).__name__}: {error}"
                found = f"{place}: {said}; expected a function (x, u, p) of what the model declares"
                raise EquationsError(found, _place_in(signal, error)) from None
            if not _is_signal(value, BATCHES[0]):
                shown = f" of shape {tuple(value.shape)}" if isinstance(value, torch.Tensor) else ""
                returned = f"returns an object of type {type(value).__name__}{shown} for signals of shape {BATCHES[0]}"
                raise EquationsError(f"{place}: {returned}; expected one number for each sample", _place_in(signal))


def _is_signal(value: object, batch: tuple[int, ...]) -> bool:
    """Whether a value is a number for each sample, or one for all."""
    if isinstance(value, torch.Tensor):
        return tuple(value.shape) in ((), batch)
    return isinstance(value, Real)


def _place_in(function: object, error: Exception | None = None) -> tuple[str, int | None] | None:
    """The file of a function, and its last line on the way to the error; its first one without any."""
    code = getattr(function, "__code__", None)
    if code is None:
        return None
    trace = None if error is None else error.__traceback__
    frames = [f for f in traceback.extract_tb(trace) if f.filename == code.co_filename]
    return code.co_filename, frames[-1].lineno if frames else code.co_firstlineno


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
        odd = _of_odd_shape(model, function, x, u, p)
        raise (UserError(odd) if odd else raised(model, error)) from None
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


def _random(model: GreyBoxModel, draw: Draw) -> EquationsError:
    if draw.frame is None:
        return EquationsError(f"`{draw.name}` in the equations of {model.title} draws random numbers; {ALONE}")
    return EquationsError(
        f"`{draw.name}` draws random numbers; {ALONE}", (draw.frame.f_code.co_filename, draw.frame.f_lineno)
    )


def raised(model: GreyBoxModel, error: Exception) -> EquationsError:
    """In words, what went wrong in the equations of ``model`` and in which line of which file."""
    frame = _frame(model, error)
    return EquationsError(
        _what_happened(model, error, frame is None), (frame.filename, frame.lineno) if frame else None
    )


def _what_happened(model: GreyBoxModel, error: Exception, outside: bool) -> str:
    """What the equations raised; ``outside`` of them where they could not even be called."""
    if any(words in str(error) for words in ("Boolean value of Tensor", "to Scalar", "to Python scalar")):
        return NEEDS_A_VALUE
    hint = advice_for(model, error)
    if outside and isinstance(error, TypeError) and "positional argument" in str(error):
        name, arguments = ("output", "x, u, p") if ".output()" in str(error) else ("derivative", "x, u, p, port")
        hint = f"; expected def {name}(self, {arguments})"
    said = _ADVICE_OF_TORCH.sub("", str(error))
    said = said.rstrip(".") if hint else said
    return f"the equations of {model.title} raised {type(error).__name__}: {said}{hint}"


def line_of(model: GreyBoxModel, error: BaseException) -> int | None:
    """The last line on the way to the error that is in a file of the model's equations."""
    frame = _frame(model, error)
    return None if frame is None else frame.lineno


def _frame(model: GreyBoxModel, error: BaseException) -> traceback.FrameSummary | None:
    files = _files(model)
    return next((f for f in reversed(traceback.extract_tb(error.__traceback__)) if f.filename in files), None)


def _files(model: GreyBoxModel) -> set[str]:
    """The files of the model's equations."""
    methods = (inspect.unwrap(getattr(type(model), name)) for name in ("derivative", "output"))
    return {code.co_filename for method in methods if (code := getattr(method, "__code__", None))}
