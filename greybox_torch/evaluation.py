"""A model judged on a data set: its free runs, what they miss, and the static laws that it contains.

This is `greybox compare` and `greybox residuals` from Python, and what those commands compute.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike

import numpy as np
import torch

from greybox_torch.data import DataSet
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.estimate.comparison import Comparison, Score, compare
from greybox_torch.estimate.overflow import avoidance, first_overflow, remedies
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.residuals import Residuals, residuals_of
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.restored import restored
from greybox_torch.simulate.stepper import make_stepper
from greybox_torch.simulate.substeps import choose_substeps
from greybox_torch.systems import load_model


@dataclass(frozen=True)
class Evaluation:
    """Free runs of a model on all experiments of ``data``, start states estimated on the first tenth of each.

    ``model_name`` is how the model is loaded; ``problem`` has the model with its values; ``substeps`` is how many Runge-Kutta steps a
    sample took; ``overflow`` says where the simulation overflows and what avoids that, None where it does not.
    """

    data: DataSet
    model_name: str
    problem: Problem
    comparison: Comparison
    substeps: int = 1
    overflow: str | None = None

    @property
    def values(self) -> dict[str, float]:
        """The parameters' values by name, those of effects among them, in their units."""
        return dict(zip(self.problem.names, map(float, self.problem.values), strict=True))

    @property
    def scores(self) -> tuple[Score, ...]:
        """Fit in % and root mean square error of every output in every experiment."""
        return self.comparison.scores

    @property
    def simulated(self) -> dict[str, np.ndarray]:
        """The simulated outputs (N, n_y), by experiment."""
        return dict(zip(self.problem.tape.names, self.comparison.simulated, strict=True))

    @cached_property
    def residuals(self) -> tuple[Residuals, ...]:
        """Errors of every output in every experiment, their whiteness, and their correlation with each input."""
        model = self.problem.model
        inputs, found = [i.name for i in model.inputs if i.name in self.data.channels], []
        for recording in self.data.recordings:
            for k, output in enumerate(model.outputs):
                simulated = self.simulated[recording.name][:, k]
                found.append(residuals_of(recording, self.data.channels[output.name], simulated, inputs))
        return tuple(found)

    def rates(
        self, states: Mapping[str, np.ndarray], inputs: Mapping[str, np.ndarray] | None = None
    ) -> dict[str, np.ndarray]:
        """What the model says of the machine at given states: the rates of all states, in their units per second.

        States and inputs that are not given are zero, and effects with a memory are as they would begin there. A static law is read off
        so, in the same way from physics and network: the friction from what slows down a machine that turns as one piece, a spring from
        what accelerates a machine at rest that is twisted.

        Args:
            states: values (M,) or numbers by state, in the states' units.
            inputs: the same for inputs.

        Raises:
            UserError: a state or input that the model does not have.
        """
        model, tape = self.problem.model, self.problem.tape
        rows = _rows(model, "state", [s.name for s in model.states], states)
        driven = _rows(model, "input", [i.name for i in model.inputs], inputs or {})
        count = max(rows.shape[1], driven.shape[1])
        rows, driven = (np.broadcast_to(part, (len(part), count)) for part in (rows, driven))
        begun = model.begun(rows.T.copy(), replace(tape, u=driven), np.arange(count), self.problem.values)
        p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in self.values.items()})
        with torch.no_grad():
            found = model.rates(torch.as_tensor(begun.T.copy()), torch.as_tensor(driven.copy()), p)
        return dict(zip((s.name for s in model.states), found.numpy(), strict=True))


def evaluate(
    data: DataSet,
    checkpoint: str | PathLike[str] | None = None,
    *,
    model: GreyBoxModel | None = None,
    device: str = "cpu",
    precision: str = "double",
) -> Evaluation:
    """Simulate all experiments of ``data`` with the card's values, or with the model of a checkpoint.

    Args:
        checkpoint: what `greybox fit`, `train` or `diagnose` have written: either of its two files, or what their names have in common.
        model: wins over the model that the card names.

    Raises:
        UserError: neither card nor caller names a model, or the checkpoint is damaged or of another model.
    """
    if model is None and data.model is None:
        raise UserError(f"{data.path}: [model] name is missing and no model is given; expected one of them")
    name = data.model if model is None or data.model is None else ""
    given = load_model(str(data.model)) if model is None else model
    return evaluated(data, given, name or given.title, checkpoint, device=device, precision=precision)


def evaluated(
    data: DataSet,
    model: GreyBoxModel,
    model_name: str,
    checkpoint: str | PathLike[str] | None = None,
    *,
    device: str = "cpu",
    precision: str = "double",
) -> Evaluation:
    """:func:`evaluate` for a model that is loaded already."""
    problem = make_problem(data, model, data.recordings)
    if checkpoint is not None:
        found = restored(data, checkpoint, model, model_name)
        data, model_name, problem = found.data, found.model_name, found.problem
    stepper = make_stepper(problem.model, (), device=device, precision=precision)
    substeps = choose_substeps(problem.driving_tape, stepper, problem.values, problem.initial) or 1
    comparison = compare(problem, data.recordings, stepper, substeps=substeps)
    found, overflow = first_overflow(problem, comparison.simulated), None
    if found is not None:
        time = next(r.time[found.sample] for r in data.recordings if r.name == found.experiment)
        overflow = (
            f"the simulation of '{found.experiment}' overflows at {time:.6g} s; "
            f"{avoidance(remedies(problem, stepper, substeps))}; "
            "try parameters and start states nearer to the truth, tighter bounds, or a smaller sample time"
        )
    return Evaluation(data, model_name, problem, comparison, substeps, overflow)


def _rows(model: GreyBoxModel, kind: str, names: list[str], given: Mapping[str, np.ndarray]) -> np.ndarray:
    """Values (n, M) of all states or inputs, zero where nothing is given."""
    for name in given:
        if name not in names:
            known = ", ".join(names)
            raise UserError(
                f"rates: model {model.title} has no {kind} '{name}'{did_you_mean(name, names)}; expected one of {known}"
            )
    arrays = [np.atleast_1d(np.asarray(given.get(name, 0.0), dtype=float)) for name in names]
    return np.stack(np.broadcast_arrays(*arrays)) if arrays else np.zeros((0, 1))
