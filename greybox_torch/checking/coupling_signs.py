"""Couplings whose port pushes against the coupling's own force: the sign of the port, or of the deflection, is turned."""

from __future__ import annotations

from collections.abc import Iterator

import torch

from greybox_torch.checking.declarations import read_as
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.points import Points
from greybox_torch.checking.source import Source
from greybox_torch.model import Coupling, GreyBoxModel
from greybox_torch.model.ports import value_of


def against_the_spring(model: GreyBoxModel, points: Points, source: Source) -> Iterator[Finding]:
    """A warning for every coupling of which the model's own force falls, at all points, as its deflection or that one's rate grows.

    The force at the port says which way the coupling's force acts on each state. What the coupling does to one state as another moves is
    looked at, as gravity or friction answer a body's own motion as well; where the deflection is one state alone, that is.
    """
    x, u, p, f = points.signals(model)
    found = model.derivative(x, u, p, f)
    rates = [torch.as_tensor(found[state.name]) for state in model.states]
    by_state = [_slopes(rate, points.x) for rate in rates]
    by_port = [_slopes(rate, points.f) for rate in rates]
    for k, port in enumerate(model.ports):
        if not isinstance(port, Coupling):
            continue
        for name in ("deflection", "rate"):
            moved = _slopes(torch.as_tensor(value_of(port.signals[name], x, u, p)), points.x)
            stiff = _stiffness(by_state, [slope[k] for slope in by_port], moved)
            if stiff is None:
                continue
            if bool((stiff <= 0.0).all()):
                written = read_as("port", port.name)
                yield Finding(
                    "warning",
                    "influence",
                    f"port '{port.name}': a force there acts against the coupling's own force, which grows with the {name}: laws that are "
                    "found there would have the wrong sign",
                    f"`{written}` with the sign of the coupling's own force, or deflection and rate turned; as it is only where that force "
                    "is meant to fall as it is wound",
                    source.file,
                    source.line_of(written) or source.line_of(f'"{port.name}"') or source.line,
                )
            break


def _stiffness(by_state: list[torch.Tensor], pushed: list[torch.Tensor], moved: torch.Tensor) -> torch.Tensor | None:
    """Of what the coupling's force does to states: numbers (m,) with the sign of its slope over what ``moved`` says; None for none.

    Args:
        by_state: slopes (n_x, B) of each rate by the states.
        pushed: slopes (B,) of each rate by the force at the port.
        moved: slopes (n_x, B) of the deflection, or of its rate, by the states.
    """
    winding = [s for s in range(len(moved)) if bool((moved[s] != 0.0).any())]
    signs = [
        by_state[r][s] * pushed[r] * moved[s]
        for s in winding
        for r in range(len(by_state))
        if len(winding) == 1 or (r != s and not bool((by_state[s][r] != 0.0).any() and r not in winding))
    ]
    if not signs:
        return None
    every = torch.cat([one[torch.isfinite(one)] for one in signs])
    every = every[every != 0.0]
    return every if len(every) else None


def _slopes(of: torch.Tensor, leaf: torch.Tensor) -> torch.Tensor:
    """The slopes of B values by each row of a leaf (n, B); zeros where they do not depend on it."""
    if not of.requires_grad:
        return torch.zeros_like(leaf)
    (slope,) = torch.autograd.grad(of.sum(), (leaf,), retain_graph=True, allow_unused=True)
    return torch.zeros_like(leaf) if slope is None else slope.detach()
