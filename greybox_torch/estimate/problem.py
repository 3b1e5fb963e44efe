"""An estimation problem: a model, recordings, and which numbers are free."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from greybox_torch.data import DataSet, Recording
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.estimate.measured_states import check_measured, measured_at
from greybox_torch.model import GreyBoxModel, Parameter, Signals, State
from greybox_torch.simulation.records import Records, make_records


@dataclass(frozen=True)
class Problem:
    """A model on some recordings.

    ``values`` (n_p,) and ``lower``, ``upper`` in physical units, in the order of the model's parameters; ``free`` (n_p,) says which
    are estimated. ``initial`` (E, n_x) start states per experiment, ``initial_free`` (n_x,) which are estimated. ``weights`` (n_y,)
    multiply the errors of the outputs. ``expected`` (n_p,) are the values that parameters are weakly held at where data say nothing:
    those that the user began with. ``carried`` (n_x,) marks states (integrated positions, time, memories) that are never free in
    a window but carried into it from the one before. ``most_noise`` (n_y,) is the largest variance that noise can have, by a fit.
    """

    model: GreyBoxModel
    records: Records
    names: tuple[str, ...]
    values: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    free: np.ndarray
    initial: np.ndarray
    initial_free: np.ndarray
    weights: np.ndarray
    carried: np.ndarray
    expected: np.ndarray
    most_noise: np.ndarray | None = None

    @property
    def free_names(self) -> tuple[str, ...]:
        """Names of the parameters that are estimated."""
        return tuple(n for n, f in zip(self.names, self.free, strict=True) if f)

    @property
    def values_by_name(self) -> dict[str, float]:
        """The parameter values by name."""
        return dict(zip(self.names, map(float, self.values), strict=True))

    @property
    def parameter_tensors(self) -> Signals:
        """The parameter values as tensors of no dimension, by name."""
        return Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in self.values_by_name.items()})

    @property
    def samples(self) -> int:
        """How many measured values there are to compare with, missing ones not counted."""
        return int((~np.isnan(self.records.y)).sum())

    @property
    def driving_records(self) -> Records:
        """The records with the inputs that drive the model at the present values."""
        return self.model.prepared(self.records, self.values)

    @property
    def window_records(self) -> Records:
        """The driving records as windows are compared with them: without what outputs show that was before the beginning."""
        return self.model.settled(self.driving_records, self.values)

    @property
    def fixed(self) -> Problem:
        """With every parameter as it is, none estimated."""
        return replace(self, free=np.zeros_like(self.free))

    @property
    def free_states(self) -> np.ndarray:
        """Indices of the states whose start value is estimated."""
        return np.flatnonzero(self.initial_free)

    def with_values(self, values: np.ndarray, initial: np.ndarray | None = None) -> Problem:
        """With other parameter values (n_p,) and, where given, other start states (E, n_x)."""
        return replace(self, values=values, initial=self.initial if initial is None else initial)

    def admissible(self, values: np.ndarray) -> bool:
        """Whether the model's joint constraints hold at ``values`` (n_p,)."""
        return bool(self.all_admissible(values[None])[0])

    def all_admissible(self, rows: np.ndarray) -> np.ndarray:
        """Whether the model's joint constraints hold (M,) at each of ``rows`` (M, n_p)."""
        columns = torch.as_tensor(np.ascontiguousarray(rows.T), dtype=torch.float64)
        quantities = self.model.admissible(Signals("parameter", dict(zip(self.names, columns, strict=True))))
        result = np.ones(len(rows), dtype=bool)
        for quantity in quantities.values():
            result &= torch.as_tensor(quantity).detach().numpy() > 0
        return result


def make_problem(
    dataset: DataSet,
    model: GreyBoxModel,
    recordings: Sequence[Recording],
    *,
    values: Mapping[str, float] | None = None,
) -> Problem:
    """The problem that a card states: start values, bounds and what is fixed from the model, overridden by the card.

    A parameter begins at the value that the model object holds, if one was set (:meth:`GreyBoxModel.held_values`), else at the card's
    start value, else at the declared one. Bounds and what is fixed are the card's wherever it speaks of them; bounds that a held
    value does not keep are moved to it.

    Args:
        values: parameter values that replace all of these (for example those of an earlier fit).

    Raises:
        UserError: a name in the card that the model does not have, a start value outside its bounds or constraints, channels that
            do not match.
    """
    records = make_records(dataset, model.plain, recordings)  # effects measure nothing of their own
    parameters = with_card(dataset, model)
    _check_names(dataset, "parameters", dataset.parameters, [p.name for p in parameters], model)
    _check_names(dataset, "initial", dataset.initial, [s.name for s in model.states], model)
    begun = {p.name: p.value for p in parameters} | model.held_values()
    numbers = begun | dict(values or {})
    problem = Problem(
        model=model,
        records=records,
        names=tuple(p.name for p in parameters),
        values=np.array([numbers[p.name] for p in parameters], dtype=float),
        lower=np.array([min(p.bounds[0], begun[p.name]) for p in parameters]),
        upper=np.array([max(p.bounds[1], begun[p.name]) for p in parameters]),
        free=np.array([not p.fixed for p in parameters], dtype=bool),
        initial=_start_states(dataset, model, records),
        initial_free=np.array([not _initial_fixed(s, dataset) for s in model.states], dtype=bool),
        weights=_weights(records),
        carried=np.isin([s.name for s in model.states], model.carried_states()),
        expected=np.array([begun[p.name] for p in parameters], dtype=float),
    )
    problem = replace(
        problem, initial=model.begun(problem.initial, problem.driving_records, records.first, problem.values)
    )
    if model.starts_free:
        problem = all_starts_free(dataset, problem)
    if not problem.admissible(problem.values):
        broken = ", ".join(model.admissible(problem.parameter_tensors))
        place = dataset.place("[model.parameters]")
        what = f"these must be positive: {broken}; expected values that keep it"
        raise UserError(f"{place} break a constraint of {model.title}: {what}")
    return problem


def all_starts_free(dataset: DataSet, problem: Problem) -> Problem:
    """``problem`` with every start state estimated that the card does not mention, whatever the model's own default.

    The memory of effects starts as they say.
    """
    own = {s.name for s in problem.model.plain.states} - set(dataset.initial)
    return replace(
        problem, initial_free=problem.initial_free | np.array([s.name in own for s in problem.model.states], dtype=bool)
    )


def problem_for(problem: Problem, model: GreyBoxModel, values: Mapping[str, float]) -> Problem:
    """``problem`` restated for an augmented ``model``: own parameters as in ``problem``, those of effects free unless declared fixed."""
    own = {n: i for i, n in enumerate(problem.names)}
    declared = list(model.declared_parameters)
    count = len(problem.model.states)
    extra = np.zeros((len(problem.initial), len(model.states) - count))
    fresh = replace(
        problem,
        model=model,
        names=tuple(p.name for p in declared),
        values=np.array(
            [values.get(p.name, problem.values[own[p.name]] if p.name in own else p.value) for p in declared]
        ),
        lower=np.array([problem.lower[own[p.name]] if p.name in own else p.bounds[0] for p in declared]),
        upper=np.array([problem.upper[own[p.name]] if p.name in own else p.bounds[1] for p in declared]),
        free=np.array([problem.free[own[p.name]] if p.name in own else not p.fixed for p in declared], dtype=bool),
        initial=np.hstack([problem.initial, extra]),
        initial_free=np.concatenate([problem.initial_free, [not s.fixed for s in model.states[count:]]]).astype(bool),
        carried=np.isin([s.name for s in model.states], model.carried_states()),
        expected=np.zeros(len(declared)),
    )
    begun = np.clip(fresh.values, fresh.lower, fresh.upper)
    expected = [problem.expected[own[p.name]] if p.name in own else v for p, v in zip(declared, begun, strict=True)]
    fresh = replace(fresh, values=begun, expected=np.array(expected))
    return replace(fresh, initial=model.begun(fresh.initial, fresh.driving_records, fresh.records.first, fresh.values))


def with_card(dataset: DataSet, model: GreyBoxModel) -> list[Parameter]:
    """The model's parameters with the start values, bounds and what is fixed that the data set's card gives.

    Raises:
        UserError: a start value outside its bounds.
    """
    return [_from_card(p, dataset) for p in model.declared_parameters]


def _from_card(parameter: Parameter, dataset: DataSet) -> Parameter:
    entry = dataset.parameters.get(parameter.name)
    if entry is None:
        return parameter
    given = {k: v for k in ("value", "lower", "upper", "fixed") if (v := getattr(entry, k)) is not None}
    try:
        return replace(parameter, **given)
    except UserError as error:
        raise UserError(f"{dataset.place('[model.parameters]')} {error}") from None


def _check_names(
    dataset: DataSet, table: str, given: Mapping[str, object], known: list[str], model: GreyBoxModel
) -> None:
    for name in given:
        if name not in known:
            raise UserError(
                f"{dataset.place(f'[model.{table}]')} {name}: model {model.title} has no such name{did_you_mean(name, known)}; "
                f"expected one of {', '.join(known)}"
            )


def _initial_fixed(state: State, dataset: DataSet) -> bool:
    entry = dataset.initial.get(state.name)
    return state.fixed if entry is None or entry.fixed is None else bool(entry.fixed)


def _start_states(dataset: DataSet, model: GreyBoxModel, records: Records) -> np.ndarray:
    """Start states (E, n_x): the card's, else the model's, measured where the model says so."""
    rows = np.zeros((len(records.first), len(model.states)))
    given = {name: entry.value for name, entry in dataset.initial.items() if entry.value is not None}
    check_measured(model.plain, [s for s in model.states if s.initial == "measured" and s.name not in given])
    for i, state in enumerate(model.states):
        if state.name in given:
            rows[:, i] = given[state.name]
        elif state.initial == "measured":
            rows[:, i] = measured_at(model.plain, state, records, records.first)
        else:
            rows[:, i] = float(state.initial)
    return rows


def _weights(records: Records) -> np.ndarray:
    """Unit weight for a single output; otherwise the inverse spread of each, so that outputs in different units count alike."""
    if len(records.y) == 1:
        return np.ones(1)
    spread = np.nanstd(records.y, axis=1)
    return 1.0 / np.where(spread > 0, spread, 1.0)
