"""Estimates that ran away: parameters far from where they began, start states far from where the machine can have been."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.digits import digits
from greybox_torch.estimate.descent import TRUSTED
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.free_run import visited_states
from greybox_torch.estimate.problem import make_problem, with_card
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.in_unit import in_unit
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.name_lists import listed

FOR_SURE = 1e8
"""Times its start value from which a parameter has run away: no card is that far off, but by a unit that is wrong."""

BADLY = 100.0
"""The same where the estimate simulates badly and the deviation is beyond the start value too; and times what a state reaches from the
start values, beyond which the start state and its deviation have run away.
"""

FEWEST_ALIKE = 3
"""Parameters from which one factor is no chance."""

MOST_APART = 2.0
"""Largest over smallest factor of parameters that went by about the same."""


def ran_away(found: Estimation, data: DataSet, fit: float) -> str | None:
    """A sentence, without its full stop, where free parameters or start states that no output shows have run away; else None.

    Args:
        fit: mean fit in % with which the estimate simulates.
    """
    names = away(found, data, fit)
    far = told_with_start(found, data, names) + _starts(found, data)
    if not far:
        return None
    return (
        f"Ran away: {listed(far)}{by_one_factor(found, data, names)}. These recordings hold no value there, or it makes up for something "
        "that the model lacks: look whether a column has the unit and scale that the card says, and terms of the equations the right sign, "
        "give bounds on the card (upper = …), or fix what is known ({ value = …, fixed = true } in [model.parameters] or [model.initial])"
    )


def away(found: Estimation, data: DataSet, fit: float) -> list[str]:
    """The names of free parameters that ran away. Arguments as for :func:`ran_away`."""
    problem, begun = found.problem, start_values(found, data)
    loose = {n for n, deviation in _widest(found).items() if deviation >= abs(begun[n])} if fit < TRUSTED else set()
    return [
        name
        for name, value in problem.values_by_name.items()
        if name in problem.free_names and abs(value) >= (BADLY if name in loose else FOR_SURE) * abs(begun[name]) > 0.0
    ]


def start_values(found: Estimation, data: DataSet) -> dict[str, float]:
    """What all parameters were begun with, by name."""
    held = found.problem.model.held_values()
    return {p.name: held.get(p.name, p.value) for p in with_card(data, found.problem.model)}


def told_with_start(found: Estimation, data: DataSet, names: Sequence[str]) -> list[str]:
    """Parameters with their estimates, and what they were begun with."""
    begun, values = start_values(found, data), found.problem.values_by_name
    units = {p.name: p.unit for p in found.problem.model.declared_parameters}
    return [in_unit(f"{n} = {values[n]:.4g}", units[n]) + f" (begun with {begun[n]:.3g})" for n in names]


def by_one_factor(found: Estimation, data: DataSet, names: Sequence[str]) -> str:
    """A clause where several parameters went the same way by about one factor, as forces of another unit take them; "" elsewhere."""
    begun, values = start_values(found, data), found.problem.values_by_name
    ratios = np.array([values[n] / begun[n] for n in names if begun[n] != 0.0])
    if len(ratios) < FEWEST_ALIKE or not (ratios > 0.0).all() or ratios.max() > MOST_APART * ratios.min():
        return ""
    middle = float(np.exp(np.log(ratios).mean()))
    size = f"{digits(middle)} times" if middle > 1.0 else f"1/{digits(1.0 / middle)}"
    return f", all of them by about {size}, as where the unit or the scale of an input is wrong by that"


def _widest(found: Estimation) -> dict[str, float]:
    """The larger of both deviations of every free parameter."""
    coloured = found.parameter_deviations("sandwich")
    return {name: max(plain, coloured[name]) for name, plain in found.parameter_deviations().items()}


def _starts(found: Estimation, data: DataSet) -> list[str]:
    """Of every state that ran away, how far, and where farthest."""
    problem = found.problem
    deviations = np.maximum(found.initial_deviations(), found.initial_deviations("sandwich"))
    shown = sensed_states(problem.model.plain)
    asked = [
        i for i in problem.free_states if problem.model.states[i].name not in shown and (deviations[:, i] > 0.0).any()
    ]
    if not asked:
        return []
    reached, told = _reached(found, data), []
    for i in asked:
        state, most = problem.model.states[i], BADLY * reached[i]
        far = np.flatnonzero((np.abs(problem.initial[:, i]) > most) & (deviations[:, i] > most))
        if len(far) and 0.0 < most < np.inf:
            e = far[np.argmax(np.abs(problem.initial[far, i]))]
            value = in_unit(f"{state.name} = {problem.initial[e, i]:.4g}", state.unit)
            size = deviations[e, i]
            spread = f"± {size:.2g}" if size < np.inf else "undetermined"
            others = f", as far in {len(far) - 1} more" if len(far) > 1 else ""
            told.append(
                f"{value} where {problem.records.names[e]} begins ({spread}; with the start values it stays within "
                f"{in_unit(f'{reached[i]:.2g}', state.unit)}){others}"
            )
    return told


def _reached(found: Estimation, data: DataSet) -> np.ndarray:
    """The largest size (n_x,) that every state reaches in free runs with the values that the estimation began with."""
    begun = make_problem(data, found.problem.model, data.estimation())
    states = visited_states(begun, simulator_for(begun, tangents=False))
    return np.max([np.abs(one).max(axis=0) for one in states], axis=0)
