"""What is wrong with a model, before any data."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.api.arguments import check_no_data
from greybox_torch.api.check_result import CheckResult
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.data_warnings import all_warnings
from greybox_torch.api.refused_tables import RefusedTable, found_and_expected
from greybox_torch.checking.examine import examine
from greybox_torch.checking.finding import Finding, in_order
from greybox_torch.checking.negative_masses import negative_masses
from greybox_torch.checking.not_finite import not_finite_at_start, not_finite_where_recorded
from greybox_torch.checking.points import Points, start_of
from greybox_torch.checking.recorded_points import recorded_points
from greybox_torch.checking.source import source_of
from greybox_torch.checking.start_states import borrowed_starts, unmeasured_starts
from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import DataWarning
from greybox_torch.errors import ArgumentError, Kind, UserError
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import model_class
from greybox_torch.systems.user_code import users_code


@names_checked
def check(model: GreyBoxModel | type[GreyBoxModel] | str, data: Data | None = None) -> CheckResult:
    """Look for what is wrong with a model: names, code that cannot be compiled, units, and what moves no output.

    Equations are read and run on made-up values; nothing is estimated.

    Args:
        model: an object, its class, or a name as :func:`greybox_torch.load_model` takes it.
        data: a data set whose channels, parameters, start states, beliefs, settings and limits are to be compared with the model's;
            or its card by path.

    Raises:
        UserError: no such model, or a file that raises when it is run. What is wrong with the model itself is among the findings.

    Examples:
        >>> import torch
        >>> from greybox_torch import GreyBoxModel, Input, Output, Parameter, State
        >>> class Lag(GreyBoxModel):
        ...     states, inputs, outputs = [State("y", "V")], [Input("v", "V")], [Output("y", "V")]
        ...     parameters = [Parameter("T", 0.1, unit="s", lower=1e-3)]
        ...     def derivative(self, x, u, p, port):
        ...         return {"y": u.v - x.y / p.T}
        ...     def output(self, x, u, p):
        ...         return {"y": x.y}
        >>> print(check(Lag()).findings[0].found)
        subtracts `u.v`, in V, and `x.y / p.T`, in V/s
    """
    name, given = _given(model)
    data = None if data is None else check_data(data)
    with users_code(_file(given), f"model {name}", "checking it"):
        examined = examine(given, None if data is None else partial(_starts, data))
        findings, values = list(examined.findings), dict[str, float]()
        if examined.model is not None and not any(f.level == "error" for f in findings):
            on_card = (
                None if data is None else {name for name, entry in data.initial.items() if entry.value is not None}
            )
            findings += unmeasured_starts(examined.model, source_of(examined.made), on_card)
            findings += borrowed_starts(examined.model, source_of(examined.made), on_card)
    if data is not None:
        usable = None if any(f.level == "error" for f in findings) else examined.model
        if usable is not None:
            told = {f.line for f in findings if f.topic == "numbers"}
            more, values = _with_data(data, usable, told)
            findings += more
        findings += [_warned(one, data) for one in all_warnings(data, usable)]
    findings = list(in_order(findings))
    card = "" if data is None or data.path is None else data.path.name
    return CheckResult(
        name, replace(examined, findings=tuple(findings)), tuple(findings), values, data is not None, card
    )


def _given(model: Any) -> tuple[str, GreyBoxModel | type[GreyBoxModel]]:
    check_no_data(model)
    if isinstance(model, str):
        return Path(model).name, model_class(model)
    held = model if isinstance(model, type | GreyBoxModel) else getattr(model, "model", None)
    if isinstance(held, type) and issubclass(held, GreyBoxModel):
        return held.__name__, held
    if isinstance(held, GreyBoxModel):
        return held.plain.title, held.plain
    raise ArgumentError("model", Kind.of(model), "expected a model, its class, or its name")


def _file(given: GreyBoxModel | type[GreyBoxModel]) -> Path:
    """Where the class stands, for messages."""
    return source_of(given if isinstance(given, type) else type(given)).file or Path("model")


def _with_data(
    data: DataSet, model: GreyBoxModel, told: Collection[int | None]
) -> tuple[list[Finding], dict[str, float]]:
    """What is wrong between the two, and the parameter values that the model begins with there.

    Args:
        told: lines of which random points have shown already that they give no numbers.
    """
    try:
        problem = make_problem(data, model, data.recordings)
    except UserError as error:
        return [_of_the_card(error, data)], {}
    values = problem.values_by_name
    source = source_of(type(model))
    starts = list(not_finite_at_start(model, source, values, _begun(problem)))
    recorded = () if starts else not_finite_where_recorded(model, *recorded_points(problem), source)
    lost = [*starts, *(f for f in recorded if f.line not in told)]
    of_values = [*lost, *negative_masses(model, source, values)]
    return of_values, values


def _warned(one: DataWarning, data: DataSet) -> Finding:
    return Finding("error" if isinstance(one, RefusedTable) else "warning", "card", one.found, one.write, data.path)


def _starts(data: DataSet, model: GreyBoxModel) -> list[Points]:
    """Where simulations of the data begin; none where the data do not fit the model."""
    try:
        problem = make_problem(data, model, data.recordings)
    except UserError:
        return []
    values = problem.values_by_name
    return [start_of(model, values, start) for start in _begun(problem).values()]


def _begun(problem: Problem) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The states and inputs that every experiment begins with, where first samples are missing the next known ones."""
    records = problem.records
    starts = zip(records.names, problem.initial, records.u[:, records.first].T, strict=True)
    return {name: (x, u) for name, x, u in starts}


def _of_the_card(error: UserError, data: DataSet) -> Finding:
    return Finding("error", "card", *found_and_expected(error, data), data.path)
