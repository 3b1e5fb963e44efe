"""What moves which output: derivatives of the equations at random points, followed from rate to rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.checking.points import Points
from greybox_torch.checking.slopes import slopes
from greybox_torch.model import GreyBoxModel

KINDS = ("state", "input", "parameter", "port")


@dataclass(frozen=True)
class Influence:
    """``moves`` (kind → (n, n_y) of bool): whether a state, input, parameter or port has an influence on an output, by way of any rates.

    ``finite`` says whether rates and outputs were numbers at each of the B points, (B,).
    """

    moves: dict[str, np.ndarray]
    finite: np.ndarray

    def outputs(self, kind: str, index: int, model: GreyBoxModel) -> list[str]:
        """The outputs that something moves."""
        return [o.name for o, moved in zip(model.outputs, self.moves[kind][index], strict=True) if moved]


def influence(model: GreyBoxModel, points: Points) -> Influence:
    """Raises whatever the equations raise."""
    x, u, p, f = points.signals(model)
    count = points.x.shape[1]
    rates = [_row(value, count) for value in _ordered(model.derivative(x, u, p, f), [s.name for s in model.states])]
    outputs = [_row(v, count) for v in _ordered(model.outputs_with(x, u, p, f), [o.name for o in model.outputs])]
    leaves = (points.x, points.u, points.p, points.f)
    of_rates = [_depends(rate, leaves) for rate in rates]
    of_outputs = [_depends(output, leaves) for output in outputs]
    reach = _reach(np.array([row[0] for row in of_rates]), np.array([row[0] for row in of_outputs]))
    moves = {"state": reach}
    for k, kind in enumerate(KINDS[1:], start=1):
        direct = np.array([row[k] for row in of_outputs]).T  # (n, n_y)
        on_rates = np.array([row[k] for row in of_rates]).T  # (n, n_x)
        moves[kind] = direct | (on_rates @ reach)
    finite = torch.stack([torch.isfinite(row) for row in (*rates, *outputs)]).all(0)
    return Influence(moves, finite.numpy())


def _ordered(values: dict[str, torch.Tensor], names: list[str]) -> list[torch.Tensor]:
    return [torch.as_tensor(values[name], dtype=torch.float64) for name in names]


def _row(value: torch.Tensor, count: int) -> torch.Tensor:
    return value.expand(count)


def _depends(value: torch.Tensor, leaves: tuple[torch.Tensor, ...]) -> tuple[np.ndarray, ...]:
    """For every leaf (n, B), which of its rows (n,) the value (B,) has a slope in at any point."""
    return tuple(((slope != 0) & torch.isfinite(slope)).any(1).numpy() for slope in slopes(value, leaves))


def _reach(rates: np.ndarray, outputs: np.ndarray) -> np.ndarray:
    """(n_x, n_y): whether a state moves an output, directly or by way of the rates of others.

    Args:
        rates: (n_x, n_x), whether the rate of the row depends on the state of the column; ``outputs`` (n_y, n_x) likewise.
    """
    reach = outputs.T.copy()
    for _ in range(len(rates)):
        reach = reach | (rates.T @ reach)
    return reach
