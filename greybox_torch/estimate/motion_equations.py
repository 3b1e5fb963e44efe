"""A model's equations along a measured motion, interval by interval: their errors, and how these depend on parameters, inputs and forces.

Slopes are differences: a pass over all samples takes less than a millisecond, and exact ones are not needed to find a direction.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.reconstruction import Motion
from greybox_torch.linear_algebra import solve
from greybox_torch.model import Body, Port, Signals
from greybox_torch.model.ports import value_of
from greybox_torch.model.signals import parameter_signals

STEP = 1e-6
"""Relative step of differences."""

INVERTIBLE = 1e-6
"""Ratio of the smallest to the largest effect that inputs have on the equations from which motion tells all that act."""

UNMOVED = 1e-2
"""Relative change of what inputs do, in units of a parameter's own, below which that parameter has no part in it."""


@dataclass(frozen=True, eq=False)
class MotionEquations:
    """The equations of ``problem``'s model along ``motion``; those that count are of the states ``rows``, R in number."""

    problem: Problem
    motion: Motion
    rows: tuple[int, ...]
    beside_inputs: dict[str, bool] = field(default_factory=dict)
    """By free parameter, whether what inputs do is the same for all its values: found once, as most models' parameters are such."""

    @staticmethod
    def of(problem: Problem, motion: Motion) -> MotionEquations:
        """Of the states that sensors show, those equations in which a parameter or a force at a port acts."""
        shown = np.flatnonzero(motion.shown)
        every = MotionEquations(problem, motion, tuple(map(int, shown)))
        slopes = [every.force_slopes(port.name) for port in problem.model.ports]
        slopes += list(every.linearised(every.start, inverse=False)[1])
        acted_on = np.zeros(len(shown), dtype=bool)
        for slope in slopes:
            acted_on |= np.abs(np.nan_to_num(slope)).max(axis=1) > 0
        return replace(every, rows=tuple(int(i) for i in shown[acted_on]))

    def at(self, values: np.ndarray) -> MotionEquations:
        """At other parameter values (n_p,)."""
        return replace(self, problem=self.problem.with_values(values))

    @property
    def start(self) -> np.ndarray:
        """The free parameters (n_free,) as the problem has them."""
        return self.problem.values[self.problem.free]

    @cached_property
    def inputs(self) -> torch.Tensor:
        """Inputs (n_u, N) as recorded."""
        return torch.as_tensor(self.motion.inputs)

    @cached_property
    def parameters(self) -> Signals:
        """As the problem has them."""
        return self._with(self.start)

    @cached_property
    def states(self) -> torch.Tensor:
        """States (n_x, N) of the problem's model in the middle of the intervals: as sensors show them, the others integrated."""
        own = self.motion.states
        x = np.zeros((len(self.problem.model.states), own.shape[1]))
        x[: len(own)] = own
        unseen = np.ones(len(x), dtype=bool)
        unseen[: len(own)] = ~self.motion.shown
        if unseen.any():
            rates = _evaluated(self.problem, torch.as_tensor(x), self.inputs, self.parameters)
            start = self.problem.initial[:, unseen]
            x[unseen] = self.motion.integrated(rates[unseen], start)
        return torch.as_tensor(x)

    def rates(self, p: Signals) -> np.ndarray:
        """Rates (R, N) as the model has them."""
        return _evaluated(self.problem, self.states, self.inputs, p)[list(self.rows)]

    def linearised(self, free: np.ndarray, *, inverse: bool) -> tuple[np.ndarray, np.ndarray]:
        """Errors (R, N) at free parameters (n_free,), in the inverse form of the inputs (n_u, N), and their slopes (n_free, R, N)."""
        with np.errstate(
            over="ignore", invalid="ignore", divide="ignore"
        ):  # where a model fails, numbers are not finite
            return self._linearised(free, inverse)

    def _linearised(self, free: np.ndarray, inverse: bool) -> tuple[np.ndarray, np.ndarray]:
        gains = self._input_slopes(self._with(free)) if inverse else None
        here, slopes = self._errors(free, gains), []
        p = self.problem
        expected, lower = p.expected[p.free], p.lower[p.free]
        for k, value in enumerate(free):
            step = np.zeros(len(free))
            step[k] = STEP * (max(abs(value), abs(expected[k])) or 1.0)
            above = self._errors(free + step, self._gains(k, free + step, gains))
            below = here
            if value - step[k] >= lower[k]:
                below = self._errors(free - step, self._gains(k, free - step, gains))
            slopes.append((above - below) / (step[k] * (1 if below is here else 2)))
        return here, np.array(slopes).reshape(len(free), *here.shape)

    def force_slopes(self, port: str) -> np.ndarray:
        """What a unit of force at a port adds to the rates, (R, N); they are affine in it."""
        model = self.problem.model
        x, u = self._states_and_inputs()
        found = []
        for size in (0.0, 1.0):
            forces = {q.name: torch.tensor(size * (q.name == port), dtype=torch.float64) for q in model.all_ports}
            with torch.no_grad():
                rates = model.derivative(x, u, self.parameters, Signals("port", forces))
            rows = [torch.as_tensor(rates[model.states[i].name], dtype=torch.float64) for i in self.rows]
            found.append(torch.stack([r.expand(self.states.shape[1]) for r in rows]).numpy())
        return found[1] - found[0]

    def signals(self, port: Port) -> dict[str, np.ndarray]:
        """The signals (N,) at a port by name; a body's position is integrated where the model has none."""
        x, u = self._states_and_inputs()
        found = {}
        for name, signal in port.signals.items():
            value = torch.as_tensor(value_of(signal, x, u, self.parameters), dtype=torch.float64)
            found[name] = value.detach().expand(self.states.shape[1]).numpy()
        if isinstance(port, Body) and "position" not in found:
            zero = np.zeros((len(self.problem.records.first), 1))
            found["position"] = self.motion.integrated(found["speed"][None], zero)[0]
        return found

    @cached_property
    def invertible(self) -> bool:
        """Whether the motion tells what acts in every equation, so that the inverse form exists."""
        if not self.rows or len(self.inputs) < len(self.rows) or not np.isfinite(self.input_slopes).all():
            return False
        sizes = np.linalg.svd(np.moveaxis(self.input_slopes, -1, 0), compute_uv=False)
        return bool((sizes[:, -1] > INVERTIBLE * sizes[:, 0]).all())

    @cached_property
    def input_slopes(self) -> np.ndarray:
        """What a unit of every input adds to the rates, (R, n_u, N), at the problem's values."""
        return self._input_slopes(self.parameters)

    def in_inputs(self, rates: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """The smallest inputs (…, n_u, N) that would change the rates by (…, R, N), by ``slopes`` (R, n_u, N)."""
        if len(self.rows) == 1:
            return rates * (slopes[0] / (slopes[0] ** 2).sum(axis=0))
        matrix = np.moveaxis(slopes, -1, 0)
        across = np.swapaxes(matrix, 1, 2)
        wanted = np.moveaxis(rates, -1, 0).reshape(len(matrix), -1, len(self.rows)).swapaxes(1, 2)
        found = across @ solve(matrix @ across, wanted)
        return np.moveaxis(found.swapaxes(1, 2).reshape(len(matrix), *rates.shape[:-2], slopes.shape[1]), 0, -1)

    def _gains(self, k: int, free: np.ndarray, gains: np.ndarray | None) -> np.ndarray | None:
        """What inputs do (R, n_u, N) with the ``k``-th free parameter beside where it was: ``gains`` where it has no part in them."""
        name = self.problem.free_names[k]
        if gains is None or self.beside_inputs.get(name):
            return gains
        moved = self._input_slopes(self._with(free))
        if name not in self.beside_inputs:
            self.beside_inputs[name] = bool(np.abs(moved - gains).max() < UNMOVED * STEP * np.abs(gains).max())
        return moved

    def _errors(self, free: np.ndarray, gains: np.ndarray | None) -> np.ndarray:
        """Errors of the rates (R, N), or the smallest inputs (n_u, N) that do as much where their ``gains`` (R, n_u, N) are given."""
        left = self.motion.rates[list(self.rows)] - self.rates(self._with(free))
        return left if gains is None else self.in_inputs(left, gains)

    def _input_slopes(self, p: Signals) -> np.ndarray:
        columns = []
        for k in range(len(self.inputs)):
            step = torch.zeros_like(self.inputs)
            step[k] = STEP * (float(self.inputs[k].abs().max()) or 1.0)
            up, down = (_evaluated(self.problem, self.states, self.inputs + s, p) for s in (step, -step))
            columns.append((up - down)[list(self.rows)] / (2 * step[k].numpy()))
        return np.stack(columns, axis=1)

    def _states_and_inputs(self) -> tuple[Signals, Signals]:
        return self.problem.model.named_signals(self.states, self.inputs)

    def _with(self, free: np.ndarray) -> Signals:
        numbers = self.problem.values_by_name
        numbers |= dict(zip(self.problem.free_names, free, strict=True))
        return parameter_signals(numbers)


def _evaluated(problem: Problem, x: torch.Tensor, u: torch.Tensor, p: Signals) -> np.ndarray:
    with torch.no_grad():
        return problem.model.rates(x, u, p).numpy()
