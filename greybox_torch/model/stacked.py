"""What a model's equations return, by name, as one tensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch

from greybox_torch.errors import UserError
from greybox_torch.model.signals import Signals


def spread(p: Any, x: torch.Tensor) -> Any:
    """Parameters that are one number, for every sample of x (n_x, *batch): a matrix is stacked of elements of one shape."""
    if x.ndim == 1:
        return p
    return Signals("parameter", {n: v.expand(x.shape[1:]) if v.ndim == 0 else v for n, v in p.items()})


def stacked(values: Mapping[str, Any], names: list[str], like: torch.Tensor, where: str) -> torch.Tensor:
    """What the equations returned, in the order of ``names``: (n, *batch), like x (n_x, *batch); ``where`` is the method's name."""
    if not isinstance(values, Mapping):
        raise UserError(
            f"{where} returned {type(values).__name__}; expected a dictionary with the keys {', '.join(names)}"
        )
    missing = [n for n in names if n not in values]
    extra = [n for n in values if n not in names]
    if missing or extra:
        found = ", ".join(values) or "nothing"
        raise UserError(f"{where} returned {found}; expected {', '.join(names)}")
    complex_ones = [
        n for n in names if isinstance(values[n], complex) or (torch.is_tensor(values[n]) and values[n].is_complex())
    ]
    if complex_ones:
        raise UserError(f"{where} returned complex numbers for {complex_ones[0]}; expected real ones")
    rows = [torch.as_tensor(values[n], dtype=like.dtype, device=like.device) for n in names]
    return torch.stack(torch.broadcast_tensors(*rows, like.select(0, 0))[:-1])


def odd_one(values: Mapping[str, Any], batch: tuple[int, ...]) -> tuple[str, tuple[int, ...]] | None:
    """The first name whose value is not one number for each sample of a ``batch``, and its shape."""
    for name, value in values.items():
        shape = tuple(torch.as_tensor(value).shape)
        same = zip(reversed(shape), reversed(batch), strict=False)
        if len(shape) > len(batch) or any(own not in (1, whole) for own, whole in same):
            return name, shape
    return None
