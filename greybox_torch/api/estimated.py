"""What an estimation says of one number: its value, how far it may be off, and within which bounds it was looked for."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.by_name import ByName
from greybox_torch.estimate.fit import Estimation


@dataclass(frozen=True)
class EstimatedStart:
    """A start state of one experiment, in ``unit``.

    ``std`` is its standard deviation where residuals are white, "std" on the console. ``std_sandwich`` is right where they are correlated
    in time too, "std (coloured)": while the model lacks something it is the one to trust, and often several times as large. Both are
    infinite where the data do not determine the number, and zero where it is ``fixed``.
    """

    value: float
    std: float
    std_sandwich: float
    unit: str
    fixed: bool


@dataclass(frozen=True)
class EstimatedParameter(EstimatedStart):
    """A parameter in ``unit``, with the bounds ``lower`` and ``upper`` that it was estimated within.

    ``std`` is its standard deviation where residuals are white, "std" on the console. ``std_sandwich`` is right where they are correlated
    in time too, "std (coloured)": while the model lacks something it is the one to trust, and often several times as large. Both are
    infinite where the data do not determine the parameter, and zero where it is ``fixed``.
    """

    lower: float
    upper: float
    description: str


def estimated_parameters(found: Estimation) -> dict[str, EstimatedParameter]:
    """By name, in the model's order."""
    problem = found.problem
    plain, sandwich = found.parameter_deviations(), found.parameter_deviations("sandwich")
    by_name = {
        declared.name: EstimatedParameter(
            value=float(problem.values[k]),
            std=plain.get(declared.name, 0.0),
            std_sandwich=sandwich.get(declared.name, 0.0),
            unit=declared.unit,
            fixed=not bool(problem.free[k]),
            lower=float(problem.lower[k]),
            upper=float(problem.upper[k]),
            description=declared.description,
        )
        for k, declared in enumerate(problem.model.declared_parameters)
    }
    return ByName(by_name)


def estimated_starts(found: Estimation, experiment: int) -> dict[str, EstimatedStart]:
    """The start states of one experiment, by name."""
    problem = found.problem
    plain, sandwich = found.initial_deviations(), found.initial_deviations("sandwich")
    return {
        state.name: EstimatedStart(
            value=float(problem.initial[experiment, i]),
            std=float(plain[experiment, i]),
            std_sandwich=float(sandwich[experiment, i]),
            unit=state.unit,
            fixed=not bool(problem.initial_free[i]),
        )
        for i, state in enumerate(problem.model.states)
    }
