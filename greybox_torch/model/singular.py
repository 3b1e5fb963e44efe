"""A matrix that has no inverse gives no number (nan) at its samples, as a division by zero does; torch would raise for all samples."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import torch
from torch.overrides import TorchFunctionMode

_WITH_INFO: dict[Any, Callable[..., Any]] = {
    torch.linalg.solve: torch.linalg.solve_ex,
    torch.linalg.inv: torch.linalg.inv_ex,
    torch.inverse: torch.linalg.inv_ex,
    torch.Tensor.inverse: torch.linalg.inv_ex,
}
"""Operations that raise where a matrix is singular, and those that tell in which of a batch it is."""


def nan_where_singular(method: Callable[..., Any]) -> Callable[..., Any]:
    """A method of equations that gives nan where a matrix cannot be inverted, and raises nothing: compiled equations do the same.

    They run as they are, and again in this way where a matrix was singular, so that others take no longer.
    """

    @functools.wraps(method)
    def called(*given: Any, **named: Any) -> Any:
        try:
            return method(*given, **named)
        except torch.linalg.LinAlgError:  # type: ignore[attr-defined]
            with _NanWhereSingular():
                return method(*given, **named)

    return called


class _NanWhereSingular(TorchFunctionMode):
    def __torch_function__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        with_info = _WITH_INFO.get(func)
        if with_info is None:
            return func(*args, **(kwargs or {}))
        found, info = with_info(*args, **(kwargs or {}))
        fine = info == 0
        return torch.where(fine.reshape(*fine.shape, *[1] * (found.ndim - fine.ndim)), found, torch.nan)
