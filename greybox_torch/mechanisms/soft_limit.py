"""A limit with a corner that may be round: x / (1 + |x|^n)^(1/n), with n = 1 / softness; without softness a clamp at ±1."""

from __future__ import annotations

from typing import Any

import torch

TINY = 1e-12
"""Keeps a logarithm and a quotient finite at zero."""


def log_of_limited(x: Any, softness: Any) -> Any:
    """The logarithm of the part of ``x``, in units of the limit, that passes.

    As a maximum and a rest, ln(1 + x^n) / n: no power overflows, and without softness it is the clamp itself.
    """
    ln_x = 0.5 * torch.log(x**2 + TINY)
    rest = torch.log1p(torch.exp(-torch.abs(ln_x) / (softness + TINY)))
    return -torch.clamp(ln_x, min=0.0) - softness * rest
