"""A machine without physics: a recurrent network of past inputs and outputs, trained on its own simulation.

    y_k = y_{k-1} + A φ_k + W tanh(B φ_k + b) + c,   φ_k = (y_{k-1}, …, y_{k-m}, u_{k-1}, …, u_{k-m})

A comes from least squares one step ahead, W begins at zero; then everything is trained on simulated windows from short to long, as the
hybrid is, with the same share of the estimation experiments held out to say when to stop.

Source: S. A. Billings, "Nonlinear System Identification: NARMAX Methods", 2013, ch. 3 and 8 (output-error training of NARX networks).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

from experiments.ablation.series import Series

MEMORY = 12
UNITS = 16
LENGTHS = ((50, 200), (200, 200), (600, 150))
"""Steps of a window, and passes over all windows of that length."""

LEARNING_RATE, LINEAR = 3e-3, 0.1
"""Of Adam at the beginning of each window length, and that of the linear part in units of it: outputs a step apart are nearly the same, so
that small changes of its weights move the poles far. Chosen among a few by the held-out windows of the robot arm, with seed 0.
"""

HELD_OUT = 0.2


class BlackBox(torch.nn.Module):
    """The recurrence in the module's formula, in scaled units."""

    def __init__(self, n_u: int, n_y: int, units: int, seed: int) -> None:
        super().__init__()
        random = torch.Generator().manual_seed(seed)
        width = MEMORY * (n_u + n_y)
        drawn = torch.randn(units, width, generator=random, dtype=torch.float64) / math.sqrt(width)
        self.n_y = n_y
        self.linear = torch.nn.Parameter(torch.zeros(n_y, width, dtype=torch.float64))
        self.hidden = torch.nn.Parameter(drawn)
        self.bias = torch.nn.Parameter(torch.randn(units, generator=random, dtype=torch.float64))
        self.out = torch.nn.Parameter(torch.zeros(units, n_y, dtype=torch.float64))
        self.constant = torch.nn.Parameter(torch.zeros(n_y, dtype=torch.float64))

    def begin(self, series: Sequence[Series]) -> None:
        """The linear part by least squares of the change of the output over a step."""
        rows, changes = [], []
        for one in series:
            past = _newest_first(one.y)[:-1].flatten(1)
            rows.append(torch.cat([past, _newest_first(one.u)[:-1].flatten(1)], dim=1))
            changes.append(one.y[MEMORY:] - one.y[MEMORY - 1 : -1])
        found = np.linalg.lstsq(torch.cat(rows).numpy(), torch.cat(changes).numpy(), rcond=1e-10)[0]
        with torch.no_grad():
            self.linear.copy_(torch.as_tensor(found.T))

    def forward(self, begun: torch.Tensor, u: torch.Tensor) -> torch.Tensor:
        """Simulated outputs (B, T, n_y) after ``begun`` (B, m, n_y) measured ones, with the inputs ``u`` (B, m + T, n_u) from there on."""
        own = MEMORY * self.n_y
        steps = u.shape[1] - MEMORY
        seen = u.unfold(1, MEMORY, 1)[:, :steps].flip(-1).transpose(2, 3).flatten(2)
        weights = torch.cat([self.linear, self.hidden])
        driven = seen @ weights[:, own:].T + torch.cat([self.constant, self.bias])
        back, past, result = weights[:, :own].T, begun.flip(1).flatten(1), []
        for k in range(steps):
            z = past @ back + driven[:, k]
            y = past[:, : self.n_y] + z[:, : self.n_y] + torch.tanh(z[:, self.n_y :]) @ self.out
            past = torch.cat([y, past[:, : -self.n_y]], dim=1)
            result.append(y)
        return torch.stack(result, dim=1)

    def simulated(self, one: Series) -> torch.Tensor:
        """The free run (N, n_y) of an experiment, its first m samples as they were measured."""
        with torch.no_grad():
            return torch.cat([one.y[:MEMORY], self(one.y[None, :MEMORY], one.u[None])[0]])


def _newest_first(signal: torch.Tensor) -> torch.Tensor:
    """The m values (N − m + 1, m, n) up to every sample of a signal (N, n)."""
    return signal.unfold(0, MEMORY, 1).flip(-1).transpose(1, 2)


@dataclass(frozen=True)
class Batch:
    begun: torch.Tensor
    u: torch.Tensor
    y: torch.Tensor
    known: torch.Tensor

    def loss(self, network: BlackBox) -> torch.Tensor:
        """Mean squared error of the simulation, in spreads of the outputs."""
        error = torch.where(self.known, network(self.begun, self.u) - self.y, 0.0)
        return (error**2).sum() / self.known.sum().clamp(min=1)


def train_black_box(series: Sequence[Series], seed: int, passes: float = 1.0) -> tuple[BlackBox, float]:
    """A network trained on some experiments, and its mean squared error on the held-out windows.

    Args:
        passes: a factor on how often the windows are gone through.
    """
    network = BlackBox(series[0].u.shape[1], series[0].y.shape[1], UNITS, seed)
    network.begin(series)
    longest = max(len(one.y) for one in series) // 4 - MEMORY
    lengths = [(length, count) for length, count in LENGTHS if length <= longest] or [(max(longest, 2), LENGTHS[0][1])]
    held_out = _stretches(series, lengths[-1][0], seed)
    random, best = np.random.default_rng([seed, 3]), _kept(network)
    judged = _windows(series, lengths[-1][0], held_out, inside=True)
    with torch.no_grad():
        least = float(judged.loss(network).nan_to_num(math.inf))
    for length, count in lengths:
        windows = _windows(series, length, held_out, inside=False)
        network.load_state_dict(best)
        adam, total = torch.optim.Adam(_groups(network)), max(1, round(passes * count))
        for done in range(total):
            for group in adam.param_groups:
                group["lr"] = group["first"] * (0.05 + 0.475 * (1 + math.cos(math.pi * done / total)))
            for part in np.array_split(random.permutation(len(windows.y)), max(1, len(windows.y) // 64)):
                _step(network, adam, _chosen(windows, part))
            with torch.no_grad():
                error = float(judged.loss(network))
            if error < least:
                best, least = _kept(network), error
    network.load_state_dict(best)
    return network, least


def _step(network: BlackBox, adam: torch.optim.Adam, batch: Batch) -> None:
    adam.zero_grad()
    loss = batch.loss(network)
    if not torch.isfinite(loss):  # a window that overflows says nothing of where to go
        return
    loss.backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
    adam.step()


def _groups(network: BlackBox) -> list[dict[str, Any]]:
    """Its parameters with their first learning rates."""
    rest = [value for name, value in network.named_parameters() if name != "linear"]
    return [
        {"params": [network.linear], "first": LINEAR * LEARNING_RATE},
        {"params": rest, "first": LEARNING_RATE},
    ]


def _kept(network: BlackBox) -> dict[str, torch.Tensor]:
    return {name: value.clone() for name, value in network.state_dict().items()}


def _stretches(series: Sequence[Series], length: int, seed: int) -> list[np.ndarray]:
    """Which samples of every experiment are held out: stretches as long as the longest windows."""
    places = [(e, first) for e, one in enumerate(series) for first in range(0, len(one.y) - length - MEMORY, length)]
    count = min(max(1, round(HELD_OUT * len(places))), len(places) - 1)
    masks = [np.zeros(len(one.y), dtype=bool) for one in series]
    for k in np.random.default_rng([seed, 1]).choice(len(places), count, replace=False):
        e, first = places[k]
        masks[e][first : first + length + MEMORY] = True
    return masks


def _windows(series: Sequence[Series], length: int, masks: Sequence[np.ndarray], *, inside: bool) -> Batch:
    """Windows of ``length`` steps that lie within the held-out stretches, or that touch none."""
    rows = []
    for one, mask in zip(series, masks, strict=True):
        for first in range(0, len(one.y) - length - MEMORY + 1, length):
            own = slice(first, first + length + MEMORY)
            if mask[own].all() if inside else not mask[own].any():
                ahead = slice(first + MEMORY, own.stop)
                rows.append((one.y[first : first + MEMORY], one.u[own], one.y[ahead], one.known[ahead]))
    return Batch(*(torch.stack(part) for part in zip(*rows, strict=True)))


def _chosen(batch: Batch, part: np.ndarray) -> Batch:
    return Batch(batch.begun[part], batch.u[part], batch.y[part], batch.known[part])
