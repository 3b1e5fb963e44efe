"""The stepper in plain torch operations: any device, no compiler, the same numbers as the compiled one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Lock

import numpy as np
import torch
from torch.func import jvp, vmap

from greybox_torch.deadline import check_time
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.simulation.packed_normals import PackedNormals
from greybox_torch.simulation.parts_of_gaps import parts_of_gaps
from greybox_torch.simulation.passes import Pass, Restarts, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import Windows

Vector = torch.Tensor
Field = Callable[[Vector, Vector, Vector], Vector]

_ONE_PASS = Lock()
"""Held by the pass that runs: the levels of torch's forward differentiation are those of the process, not of a thread."""


@dataclass(frozen=True)
class EagerStepper:
    """See :class:`greybox_torch.simulation.stepper.Stepper`."""

    model: GreyBoxModel
    sensitive: tuple[str, ...]
    device: torch.device
    dtype: torch.dtype

    @staticmethod
    def of(model: GreyBoxModel, sensitive: Sequence[str], device: str, precision: str) -> EagerStepper:
        dtype = torch.float64 if precision == "double" else torch.float32
        return EagerStepper(model, tuple(sensitive), torch.device(device), dtype)

    @property
    def compiled(self) -> bool:
        return False

    def run(self, records: Records, asked: Pass, substeps: int = 1) -> Run:
        with _ONE_PASS:
            return self._run(records, asked, substeps)

    def _run(self, records: Records, asked: Pass, substeps: int) -> Run:
        windows, weights = asked.windows, asked.weights
        count, n_x = len(windows.start), len(self.model.states)
        n_p = len(self.sensitive) if asked.tangents else 0
        n_s = 0 if asked.start_directions is None else asked.start_directions.shape[1]
        values = self._tensor(
            np.broadcast_to(np.atleast_2d(asked.parameters), (count, len(self.model.declared_parameters))).T
        )
        x = self._tensor(asked.starts.T)
        dx = torch.zeros(n_p + n_s, n_x, count, dtype=self.dtype, device=self.device)
        if n_p and asked.tangents0 is not None:
            dx[:n_p] = self._tensor(np.moveaxis(asked.tangents0, 0, -1))
        if asked.start_directions is not None:
            dx[n_p:] = self._tensor(np.moveaxis(asked.start_directions, 0, -1))
        dp = self._parameter_directions(n_p, n_s, count)
        ys, dys, xs = [], [], []
        begun = [x]
        with torch.no_grad():
            for n, (u0, u1, dt, parts) in enumerate(self._inputs(records, windows)):
                check_time()  # a pass takes seconds here
                if asked.restarts is not None and n and n % asked.restarts.every == 0:
                    x = self._restarted(x, asked.restarts, n // asked.restarts.every)
                    begun.append(x)
                y, dy = self._pushed(self._outputs, x, u0, values, dx, dp)
                ys.append(y)
                dys.append(dy)
                if asked.keep_states:
                    xs.append(x)
                steps = substeps * parts
                for m in range(steps):
                    step = runge_kutta_step(self._rates, u0, u1, dt / steps, m / steps, (m + 1) / steps)
                    x, dx = self._pushed(step, x, u0, values, dx, dp)
        directed = n_p + n_s > 0
        y = _array(torch.stack(ys), (2, 0, 1))
        dy = _array(torch.stack(dys), (3, 0, 2, 1)) if directed else np.zeros((*y.shape, 0))
        normal = None if weights is None else _normal(records, windows, y, dy, weights)
        return Run(
            y=y,
            dy=dy if directed and weights is None else None,
            x_end=_array(x, (1, 0)),
            dx_end=_array(dx, (2, 0, 1)) if directed else None,
            states=_array(torch.stack(xs), (2, 0, 1)) if asked.keep_states else None,
            begun=None if asked.restarts is None else _array(torch.stack(begun), (2, 0, 1)),
            normal=None if asked.probes is not None else normal,
            packed=None
            if asked.probes is None or normal is None
            else PackedNormals.whole(normal[..., None], len(normal)),
        )

    def _restarted(self, x: Vector, restarts: Restarts, k: int) -> Vector:
        """The states with which windows go on at their ``k``-th restart; as they are where there is none."""
        if k >= restarts.starts.shape[1]:
            return x
        kept = torch.as_tensor(restarts.kept, device=self.device)[:, None]
        return torch.where(kept, torch.where(x == x, x, 0.0), self._tensor(restarts.starts[:, k].T))

    def _pushed(
        self, function: Field, x: Vector, u: Vector, p: Vector, dx: Vector, dp: Vector
    ) -> tuple[Vector, Vector]:
        """Value and directional derivatives of ``function`` at (x, p)."""
        if not len(dx):
            return function(x, u, p), dx
        along = vmap(lambda a, b: jvp(lambda z, q: function(z, u, q), (x, p), (a, b)), out_dims=(None, 0))  # type: ignore[arg-type]
        return along(dx, dp)  # type: ignore[return-value]

    def _rates(self, x: Vector, u: Vector, p: Vector) -> Vector:
        return self.model.rates(x, u, self._named(p))

    def _outputs(self, x: Vector, u: Vector, p: Vector) -> Vector:
        return self.model.measured(x, u, self._named(p))

    def _named(self, p: Vector) -> Signals:
        return Signals("parameter", {d.name: p[i] for i, d in enumerate(self.model.declared_parameters)})

    def _parameter_directions(self, n_p: int, n_s: int, count: int) -> Vector:
        names = [d.name for d in self.model.declared_parameters]
        dp = torch.zeros(n_p + n_s, len(names), count, dtype=self.dtype, device=self.device)
        for k, name in enumerate(self.sensitive[:n_p]):
            dp[k, names.index(name)] = 1.0
        return dp

    def _inputs(self, records: Records, windows: Windows):
        u, dt, parts = self._tensor(records.u), self._tensor(records.dt), parts_of_gaps(records)
        start, last = (torch.as_tensor(a, device=self.device) for a in (windows.start, windows.last))
        for n in range(windows.steps):
            now, following = torch.minimum(start + n, last), torch.minimum(start + n + 1, last)
            u0 = u[:, now]
            most = 1 if parts is None else int(parts[np.minimum(windows.start + n, windows.last)].max())
            yield u0, (u[:, following] if records.hold == "foh" else u0), dt[now], most

    def _tensor(self, values: np.ndarray) -> Vector:
        return torch.as_tensor(np.array(values), dtype=self.dtype, device=self.device)


def runge_kutta_step(rates: Field, u0: Vector, u1: Vector, h: Vector, start: float, end: float) -> Field:
    """One Runge-Kutta step over the part [start, end] of a sample interval."""
    slope = u1 - u0
    a, middle, b = u0 + start * slope, u0 + 0.5 * (start + end) * slope, u0 + end * slope

    def step(x: Vector, _: Vector, p: Vector) -> Vector:
        k1 = rates(x, a, p)
        k2 = rates(x + 0.5 * h * k1, middle, p)
        k3 = rates(x + 0.5 * h * k2, middle, p)
        k4 = rates(x + h * k3, b, p)
        return x + h / 6 * (k1 + 2 * (k2 + k3) + k4)

    return step


def _normal(records: Records, windows: Windows, y: np.ndarray, dy: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """[J e]ᵀ[J e] per window."""
    index = windows.start[:, None] + np.arange(windows.steps)
    inside = (index <= windows.last[:, None])[..., None]
    measured = np.moveaxis(records.y[:, np.minimum(index, windows.last[:, None])], 0, -1)
    known = inside & ~np.isnan(measured)
    error = np.where(known, (measured - y) * weights, 0.0)[..., None]
    rows = np.concatenate([np.where(known[..., None], dy * weights[:, None], 0.0), error], axis=-1).reshape(
        len(y), -1, dy.shape[-1] + 1
    )
    return np.swapaxes(rows, 1, 2) @ rows


def _array(values: Vector, order: tuple[int, ...]) -> np.ndarray:
    return values.permute(order).cpu().numpy().astype(np.float64)
