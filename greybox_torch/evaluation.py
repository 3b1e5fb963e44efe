"""A model judged on a data set: its free runs, what they miss, and the static laws that it contains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np

from greybox_torch.data import DataSet, load_dataset
from greybox_torch.errors import ArgumentError, Kind, UserError
from greybox_torch.estimate.comparison import Comparison, compare
from greybox_torch.estimate.divergence import FAR, diverges_from
from greybox_torch.estimate.overflow import NO_NUMBER, Overflow, avoidance, overflows, suggestions
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.residuals import Residuals, residuals_of
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.in_unit import in_unit
from greybox_torch.model import GreyBoxModel
from greybox_torch.name_lists import further, listed
from greybox_torch.rates import rates_at
from greybox_torch.restored import load_beside
from greybox_torch.simulation.simulator import SimulationOptions
from greybox_torch.systems import load_model, model_reference

MOST_NAMED = 5
"""Experiments that a message on an overflow names."""


@dataclass(frozen=True, repr=False)
class Evaluation:
    """Free runs of a model on all experiments of ``data``, start states estimated on the first tenth of each.

    ``model_name`` is how the model is loaded; ``problem`` has the model with its values; ``substeps`` is how many Runge-Kutta steps a
    sample took; ``overflow`` says where the simulation overflows and what avoids that, None where it does not; ``lost`` are the
    experiments in which it does.
    """

    data: DataSet
    model_name: str
    problem: Problem
    comparison: Comparison
    substeps: int = 1
    overflow: str | None = None
    lost: tuple[str, ...] = ()

    def __repr__(self) -> str:
        title, effects = self.problem.model.title, self.problem.model.effects_told()
        lines = [f"{self.data.name}: {f'{title} with {listed(effects)}' if effects else title}"]
        for row in self.scores:
            error = in_unit(f"{row['rmse']:.5g}", row["unit"])
            place = f"{row['experiment']} ({row['role']}), {row['output']}"
            lines.append(f"  {place}: fit {row['fit']:.5g} %, root mean square error {error}")
        return "\n".join([*lines, *([] if self.overflow is None else [f"warning: {self.overflow}."])])

    @property
    def values(self) -> dict[str, float]:
        """The parameters' values by name, those of effects among them, in their units."""
        return self.problem.values_by_name

    @property
    def initial(self) -> dict[str, dict[str, float]]:
        """The start states by experiment and state, in the states' units."""
        names = [state.name for state in self.problem.model.states]
        return {
            experiment: dict(zip(names, map(float, row), strict=True))
            for experiment, row in zip(self.comparison.experiments, self.comparison.initial, strict=True)
        }

    @property
    def scores(self) -> list[dict[str, Any]]:
        """A row for every output of every experiment: fit in %, root mean square error in the output's unit."""
        return [{**asdict(score), "unit": self.data.channels[score.output].unit} for score in self.comparison.scores]

    @property
    def simulated(self) -> dict[str, np.ndarray]:
        """The simulated outputs (N, n_y), by experiment."""
        return self.comparison.by_experiment

    @cached_property
    def diverging(self) -> tuple[str, ...]:
        """A sentence for each experiment, of very many the first few, whose simulation ends far from what was measured."""
        told = []
        for recording in self.data.recordings:
            if recording.name in self.lost:
                continue
            since = recording.time - recording.time[0]
            for k, output in enumerate(self.problem.model.outputs):
                begin = diverges_from(recording.signals[output.name], self.simulated[recording.name][:, k])
                if begin is not None:
                    when = f"from {since[begin]:.3g} s after the start on {output.name} is more than {FAR:.0f} times its measured range off"
                    told.append(
                        f"the simulation of '{recording.name}' diverges, so that fits say nothing: {when}. The model is unstable with "
                        "these values; check the signs in its equations and on the card"
                    )
                    break
        return tuple(told[:MOST_NAMED])

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

    def rates(self, states: Mapping[str, Any], inputs: Mapping[str, Any] | None = None) -> dict[str, np.ndarray]:
        """The rates of all states at given states and inputs, see :func:`greybox_torch.rates.rates_at`."""
        return rates_at(self.problem.model, self.values, states, inputs)


def evaluate(
    data: DataSet | str | PathLike[str],
    checkpoint: str | PathLike[str] | None = None,
    *,
    model: GreyBoxModel | None = None,
    device: str = "cpu",
    precision: str = "double",
) -> Evaluation:
    """Simulate all experiments of ``data`` with the card's values, or with the model of a checkpoint.

    Args:
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        checkpoint: what `greybox fit`, `train` or `diagnose` have written: either of its two files, what their names have in
            common, or the folder that it is in.
        model: wins over the model that the card names; either stands in for a checkpoint's whose class is not where it was.
        device: "cpu", "cuda" or "cuda:N".
        precision: "double" or "single".

    Raises:
        UserError: neither card nor caller names a model, or the checkpoint is damaged or of another model.
    """
    if isinstance(data, str | PathLike):
        data = load_dataset(data)
    if not isinstance(data, DataSet):
        raise ArgumentError(
            "data", Kind.of(data), "expected a DataSet first, or a card by path, as in evaluate(data, model=Motor())"
        )
    if model is None and data.model is None:
        raise UserError(f"{data.place('[model] name')} is missing and no model is given; expected one of them")
    given = load_model(str(data.model)) if model is None else model
    if checkpoint is None:
        return evaluated(data, given, device=device, precision=precision)
    loaded, data = load_beside(checkpoint, given, data)
    return evaluated(data, loaded, device=device, precision=precision)


def evaluated(data: DataSet, model: GreyBoxModel, *, device: str = "cpu", precision: str = "double") -> Evaluation:
    """Simulate all experiments of ``data`` with the values that ``model`` holds, the card's where it holds none of its own."""
    problem = make_problem(data, model, data.recordings)
    simulator = simulator_for(problem, SimulationOptions(device, precision), tangents=False)
    comparison = compare(problem, data.recordings, simulator)
    found, overflow = overflows(problem, comparison.simulated), None
    if found:
        overflow = (
            f"{_told(data, found)}; "
            f"{avoidance(suggestions(problem, simulator))}; "
            "try parameters and start states nearer to the truth, tighter bounds, or a smaller sample time"
        )
    lost = tuple(one.experiment for one in found)
    return Evaluation(data, model_reference(model), problem, comparison, simulator.substeps, overflow, lost)


def _told(data: DataSet, found: tuple[Overflow, ...]) -> str:
    """Where and when the simulation overflows; of many experiments the first few."""
    times = {r.name: r.time for r in data.recordings}
    at = [f"at {times[o.experiment][o.sample]:.6g} s" for o in found[:MOST_NAMED]]
    others = [f"of '{o.experiment}' {when}" for o, when in zip(found[1:], at[1:], strict=False)]
    others += [f"of {further(len(found) - MOST_NAMED, 'experiment')}"] if len(found) > MOST_NAMED else []
    told = ", ".join([f"the simulation of '{found[0].experiment}' overflows {at[0]}", *others])
    return f"{told} ({NO_NUMBER})" if found[0].no_number else told
