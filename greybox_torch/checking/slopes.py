"""Slopes of the equations at the points where they are tried."""

from __future__ import annotations

from collections.abc import Sequence

import torch


def slopes(of: torch.Tensor, leaves: Sequence[torch.Tensor]) -> tuple[torch.Tensor, ...]:
    """The slopes of B values by each row of every leaf (n, B); zeros where they do not depend on it."""
    if not of.requires_grad:
        return tuple(torch.zeros_like(leaf) for leaf in leaves)
    found = torch.autograd.grad(of.sum(), leaves, retain_graph=True, allow_unused=True)
    return tuple(torch.zeros_like(x) if g is None else g.detach() for g, x in zip(found, leaves, strict=True))
