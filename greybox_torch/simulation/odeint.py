"""The torchdiffeq route: reference integrator, adaptive steps, and the adjoint.

The integration variable is the sample index s, with dx/ds = dt(s) f(x, u(s), p), so that unevenly sampled records and windows that
start anywhere share one grid.
"""

from __future__ import annotations

from typing import Any

import torch
from torchdiffeq import odeint, odeint_adjoint

from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import Windows

FIXED = ("euler", "midpoint", "rk4", "explicit_adams", "implicit_adams", "heun3")


class VectorField(torch.nn.Module):
    """dx/ds of ``model`` on some windows of records, for torchdiffeq. State x is (n_x, W)."""

    def __init__(
        self,
        model: GreyBoxModel,
        records: Records,
        windows: Windows,
        device: str = "cpu",
        values: torch.Tensor | None = None,
    ) -> None:
        super().__init__()
        self.u: torch.Tensor
        self.dt: torch.Tensor
        self.start: torch.Tensor
        self.last: torch.Tensor
        self.model = model
        self.values = values
        self.hold = records.hold
        self.register_buffer("u", torch.as_tensor(records.u, device=device))
        self.register_buffer("dt", torch.as_tensor(records.dt, device=device))
        self.register_buffer("start", torch.as_tensor(windows.start, device=device))
        self.register_buffer("last", torch.as_tensor(windows.last, device=device))

    def forward(self, s: torch.Tensor, x: torch.Tensor) -> torch.Tensor:
        now = torch.minimum(self.start + torch.floor(s).long(), self.last)
        return self.dt[now] * self.model.rates(x, self.input_at(s), self.parameters_by_name())

    def parameters_by_name(self) -> Signals:
        """The parameters in physical units: the values given, or the model's own."""
        if self.values is None:
            return self.model.physical()
        names = (p.name for p in self.model.declared_parameters)
        return Signals("parameter", dict(zip(names, self.values.unbind(), strict=True)))

    def input_at(self, s: torch.Tensor) -> torch.Tensor:
        """The input (n_u, W) at sample index ``s``, as the hold says."""
        whole = torch.floor(s)
        now = torch.minimum(self.start + whole.long(), self.last)
        if self.hold == "zoh":
            return self.u[:, now]
        following = torch.minimum(now + 1, self.last)
        return self.u[:, now] + (s - whole) * (self.u[:, following] - self.u[:, now])


def solve(
    model: GreyBoxModel,
    records: Records,
    windows: Windows,
    x0: torch.Tensor,
    *,
    values: torch.Tensor | None = None,
    method: str = "rk4",
    adjoint: bool = False,
    substeps: int = 1,
    rtol: float = 1e-9,
    atol: float = 1e-10,
) -> torch.Tensor:
    """Outputs (n_y, K, W) of windows of K samples, differentiable in the parameters and in ``x0`` (n_x, W).

    Fixed-step methods make ``substeps`` steps a sample and see the input as constant (or linear) within it; adaptive ones are told where
    the input jumps. With ``adjoint`` the gradient is that of the continuous adjoint equation, in constant memory (Chen et al. 2018).

    Args:
        values: parameters (n_p,) in physical units and declared order; the model's own by default.
    """
    field = VectorField(model, records, windows, str(x0.device), values)
    grid = torch.arange(windows.steps, dtype=x0.dtype, device=x0.device)
    options: dict[str, Any] = {"perturb": True} if method in FIXED else {"jump_t": grid[1:-1]}
    if method in FIXED and substeps > 1:
        options["step_size"] = 1.0 / substeps
    extra: dict[str, Any] = {"adjoint_options": dict(options)} if adjoint else {}
    if adjoint and method not in FIXED:
        extra["adjoint_options"] = {"jump_t": grid[1:-1]}
    if adjoint and values is not None:
        extra["adjoint_params"] = (values,)
    integrate = odeint_adjoint if adjoint else odeint
    states: torch.Tensor = integrate(field, x0, grid, method=method, rtol=rtol, atol=atol, options=options, **extra)  # type: ignore[assignment]
    p = field.parameters_by_name()
    outputs = [model.measured(states[k], field.input_at(grid[k]), p) for k in range(windows.steps)]
    return torch.stack(outputs, dim=1)
