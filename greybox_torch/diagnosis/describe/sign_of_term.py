"""A law that does what a parameter of the model would do beyond its range: a term of the user's equations may have the wrong sign."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.describe.along_records import along_records
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.rates_and_outputs import RatesAndOutputs
from greybox_torch.in_unit import in_unit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import SHARE

ELSE = 0.01
"""Share of the variance of what a law changes, of any rate or output, up to which a parameter does the same."""

NOTHING = 1e-8
"""Part of a rate's or an output's size below which what is changed of it is rounding."""

TURNED = 0.1
"""Part of a parameter's change that lies beyond zero, at least: a term that the machine does not have ends at zero."""


def sign_of_term(fitted: Hypothesis, final: Final, attachment: Attachment) -> str:
    """A clause where a law does what a parameter of the model would do with another sign than it may have; "" elsewhere.

    Seen: gravity with the wrong sign in the equations of a pendulum, told as gravity at the load with exactly twice the card's amplitude.
    """
    model, problem = fitted.model, final.problem
    if attachment.mechanism.free or not isinstance(model, AugmentedModel):
        return ""
    changes, switch = _changes(model, fitted, final, attachment), f"{attachment.prefix}.{SHARE}"
    found = turned(changes, problem, [p.name for p in model.base.declared_parameters], switch)
    if found is None:
        return ""
    (name, value), units = found, {p.name: p.unit for p in model.base.declared_parameters}
    card = digits(float(problem.expected[problem.names.index(name)]), 3)
    return (
        f"it does what {name} = {in_unit(digits(value, 3), units[name])} would do ({card} on the card): is the sign of that term in the "
        "equations right?"
    )


def turned(changes: RatesAndOutputs, problem: Problem, names: Sequence[str], switch: str) -> tuple[str, float] | None:
    """The first of the parameters ``names``, free ones before, that does with a value of the other sign than it may have what the law of a
    ``switch`` does, and that value; None where there is none.
    """
    by_law = changes.between({switch: 0.0}, {switch: 1.0})
    rounding = NOTHING * np.abs(changes.of({})).max(axis=1)
    if not np.isfinite(by_law).all():
        return None
    for name in sorted(names, key=lambda name: name not in problem.free_names):
        value = _turned(changes, problem, name, switch, by_law, rounding)
        if value is not None:
            return name, value
    return None


def _changes(model: AugmentedModel, fitted: Hypothesis, final: Final, attachment: Attachment) -> RatesAndOutputs:
    """The model with a switch for the law, at samples that the records visit, with the recommended values."""
    switched = AugmentedModel(model.base, model.attachments, model.surroundings, switched=(attachment,))
    return along_records(fitted, switched, {**final.values(), f"{attachment.prefix}.{SHARE}": 1.0})


def _turned(
    changes: RatesAndOutputs, problem: Problem, name: str, switch: str, by_law: np.ndarray, rounding: np.ndarray
) -> float | None:
    """That value of a parameter; None where it has none."""
    k, off = problem.names.index(name), {switch: 0.0}
    value, low, high = (float(of[k]) for of in (problem.values, problem.lower, problem.upper))
    fixed = name not in problem.free_names
    above, below = low >= 0.0 or (fixed and value > 0.0), high <= 0.0 or (fixed and value < 0.0)
    slope = changes.slope(name, (low, high), float(problem.expected[k]), off)
    size = np.sqrt((by_law**2).mean(axis=1))
    rows = size > rounding
    by_unit, wanted = (of[rows] / size[rows, None] for of in (slope, by_law))
    strength = float((by_unit**2).sum())
    if above == below or not rows.any() or not 0.0 < strength < np.inf:
        return None
    change = float((by_unit * wanted).sum()) / strength
    turned = value + change
    if (-turned if above else turned) <= TURNED * abs(change):
        return None
    left = ((changes.between(off, {**off, name: turned}) - by_law) ** 2).mean(axis=1)
    alike = left <= ELSE * by_law.var(axis=1) + rounding**2
    return turned if alike.all() else None
