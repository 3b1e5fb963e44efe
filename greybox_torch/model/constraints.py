"""The constraint transform of a learnable parameter."""

from __future__ import annotations

import math
from typing import Any

import torch


class _Projection(torch.autograd.Function):
    """Clamp to an interval whose gradient is blocked only where following it would leave the interval.

    ``torch.clamp`` loses the gradient beyond a bound, and smooth transforms (softplus, square, sigmoid) have no slope at the bound
    itself, so that a parameter starting there (``k_g3 = 0``) would never move. Here descent may always re-enter the interval.
    """

    @staticmethod
    def forward(ctx: Any, raw: torch.Tensor, lower: float, upper: float) -> torch.Tensor:
        ctx.save_for_backward(raw)
        ctx.bounds = (lower, upper)
        return raw.clamp(lower, upper)

    @staticmethod
    def backward(ctx: Any, *grads: torch.Tensor) -> tuple[torch.Tensor, None, None]:
        (raw,) = ctx.saved_tensors
        lower, upper = ctx.bounds
        grad = grads[0]
        leaves = ((raw <= lower) & (grad > 0)) | ((raw >= upper) & (grad < 0))
        return torch.where(leaves, torch.zeros_like(grad), grad), None, None


def project(raw: torch.Tensor, lower: float, upper: float) -> torch.Tensor:
    """``raw`` held within [lower, upper], with a gradient that works exactly at the bounds.

    At a bound the gradient is that of a projected descent step: it passes if the step points inwards and is zero otherwise.
    """
    if lower == float("-inf") and upper == float("inf"):
        return raw
    return _Projection.apply(raw, lower, upper)  # type: ignore[no-any-return]


def parameter_scale(value: float, lower: float, upper: float) -> float:
    """A typical size of a parameter, so that optimisers see numbers of order one.

    That of the value where it is not zero, else that of the width of its interval, else one; rounded down to a power of two, so that
    scaling changes no digit of a number.
    """
    width = upper - lower
    size = abs(value) or (width if 0.0 < width < float("inf") else 1.0)
    return math.ldexp(1.0, math.frexp(size)[1] - 1)
