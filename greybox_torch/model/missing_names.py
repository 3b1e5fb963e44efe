"""What to write where equations use a name that is not there (one of torch, of the model itself, or of a module that is not imported), or
an element of what is one number."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import torch

from greybox_torch.errors import did_you_mean
from greybox_torch.model.own_weights import not_double

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel

_LIBRARIES = ("np", "numpy", "math", "cmath", "scipy", "sp")
_OF_TORCH = "functions of torch (import torch), such as torch.sin: those of math and numpy cannot take tensors"
_ATTRIBUTE = re.compile(r"module 'torch' has no attribute '(\w+)'")


def advice_for(model: GreyBoxModel, error: Exception) -> str:
    """`; expected …`, to go on in a message about what equations raised; "" where the error is of another kind."""
    if isinstance(error, NameError) and error.name:
        return f"; expected {_named(model, error.name)}"
    if isinstance(error, ImportError):
        return f"; expected a module that is installed here; or {_OF_TORCH}"
    if isinstance(error, AttributeError) and (missing := _ATTRIBUTE.search(str(error))):
        return f"; expected a function of torch{did_you_mean(missing[1], dir(torch))}"
    if "0-dim tensor" in str(error):
        return "; expected a signal as it is, without an index: it is one number for each sample"
    if "dtype" in str(error):
        return not_double(model)
    return f"; expected {_OF_TORCH}" if "numpy" in str(error) else ""


def _named(model: GreyBoxModel, name: str) -> str:
    own = {"x": model.states, "u": model.inputs, "p": model.declared_parameters, "port": model.ports}
    for argument, items in own.items():
        if name in [item.name for item in items]:
            return f"{argument}.{name}"
    if name == "torch":
        return "import torch at the top of the file"
    if name in _LIBRARIES:
        return _OF_TORCH
    if callable(getattr(torch, name, None)):
        return (
            f"torch.{name}, with import torch at the top of the file: functions of math and numpy cannot take tensors"
        )
    if hasattr(torch, name):
        return f"torch.{name}, with import torch at the top of the file"
    return f"`{name}` imported or defined at the top of the file"
