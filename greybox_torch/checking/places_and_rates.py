"""A port's speed, or a coupling's rate, that is not how its position, or deflection, changes along the equations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import torch

from greybox_torch.checking.finding import Finding
from greybox_torch.checking.points import Points
from greybox_torch.checking.slopes import slopes
from greybox_torch.checking.source import Source
from greybox_torch.model import Body, Coupling, GreyBoxModel
from greybox_torch.model.ports import value_of

AS_ONE = 1e-6
"""Relative deviation up to which two rates are the same."""


def rates_of_places(model: GreyBoxModel, points: Points, source: Source) -> Iterator[Finding]:
    """A warning for every body whose speed, and every coupling whose rate, has another sign than what its position, or deflection, does
    along the equations without a force at the ports, or depends on other states.

    A factor above zero is right at a body, whose position may be in other units; the signals of a coupling are of one unit. Nothing is said
    where one of them shows an input, as of a speed beside that of a wind, nor where the position stands still.
    """
    alike = torch.ones_like(points.p) * points.p[:, :1].detach()  # a factor that is a parameter is one factor
    still = replace(points, p=alike, f=torch.zeros_like(points.f))
    x, u, p, f = still.signals(model)
    found = model.derivative(x, u, p, f)
    rates = torch.stack([torch.as_tensor(found[s.name]).detach().expand(still.x.shape[1]) for s in model.states])
    for port in model.ports:
        place, rate = ("position", "speed") if isinstance(port, Body) else ("deflection", "rate")
        if not isinstance(port, Body | Coupling) or {place, rate} - set(port.signals):
            continue
        where, speed = (torch.as_tensor(value_of(port.signals[name], x, u, p)) for name in (place, rate))
        by_state, by_input = slopes(where, (still.x, still.u))
        if bool((by_input != 0.0).any()) or bool((slopes(speed, (still.u,))[0] != 0.0).any()):
            continue
        odd = _odd(by_state * rates, speed.detach().expand(still.x.shape[1]), isinstance(port, Coupling))
        if odd is not None:
            yield Finding(
                "warning",
                "influence",
                f"port '{port.name}': its {rate} {odd}, by which its {place} changes in the equations: laws that are found there would "
                "follow the wrong one",
                f"the rate of its {place} as its {rate}: of the same states, with the same factors and signs",
                source.file,
                source.line_of(f'"{port.name}"') or source.line,
            )


def _odd(parts: torch.Tensor, speed: torch.Tensor, coupling: bool) -> str | None:
    """How a speed (B,) differs from the sum of ``parts`` (n_x, B), by which the place changes; None where it does not."""
    known = torch.isfinite(parts).all(0) & torch.isfinite(speed)
    parts, speed = parts[:, known], speed[known]
    changes, size = parts.sum(0), parts.abs().sum(0)
    if not bool((changes != 0.0).any()) or not bool((speed != 0.0).any()):
        return None
    times = float((speed * changes).sum() / (changes * changes).sum())
    deviation = (speed - times * changes).abs()
    if bool((deviation > AS_ONE * (abs(times) * size + speed.abs())).any()):
        return "does not depend on the states as the rate does"
    if abs(times + 1.0) <= AS_ONE:
        return "has the other sign than the rate"
    return f"is {times:.4g} times the rate" if times < 0.0 or (coupling and abs(times - 1.0) > AS_ONE) else None
