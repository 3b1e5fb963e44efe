"""Trying a model's equations once, so that a mistake in them is reported where it is made."""

from __future__ import annotations

import traceback
from pathlib import Path

import torch

from greybox_torch.errors import UserError
from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.signals import Signals

BRANCHES_ON_SIGNAL = (
    "the model's equations branch on the value of a signal (a Python `if`, `float()` or `.item()` on a tensor); "
    "write torch.where(condition, yes, no) instead, so that all samples can be computed side by side"
)


def check_equations(model: GreyBoxModel) -> None:
    """Evaluates the model's rates and outputs on a small batch of zeros.

    Raises:
        UserError: ``derivative()`` or ``output()`` raises, branches on a signal, or does not return what the model declares.
    """
    batch = 2
    x = torch.zeros(len(model.states), batch, dtype=torch.float64)
    u = torch.zeros(len(model.inputs), batch, dtype=torch.float64)
    with torch.no_grad():
        values = model.physical()
        p = Signals("parameter", {name: value.expand(batch) for name, value in values.items()})
        for function in (model.rates, model.measured):
            try:
                function(x, u, p)
            except UserError:
                raise
            except Exception as error:
                raise UserError(explain(model, error)) from None


def explain(model: GreyBoxModel, error: Exception) -> str:
    """In words, what went wrong in the equations of ``model`` and in which line of which file."""
    place = _place(model, error)
    if "Boolean value of Tensor" in str(error) or "converted to Scalar" in str(error):
        return f"{place}{BRANCHES_ON_SIGNAL}"
    return f"{place}the equations of {model.title} raised {type(error).__name__}: {error}"


def _place(model: GreyBoxModel, error: Exception) -> str:
    """The last line on the way to the error that is in a method of the model's own file."""
    files = {
        code.co_filename
        for m in ("derivative", "output")
        if (code := getattr(getattr(type(model), m), "__code__", None))
    }
    lines = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename in files]
    return f"{Path(lines[-1].filename).name}, line {lines[-1].lineno}: " if lines else ""
