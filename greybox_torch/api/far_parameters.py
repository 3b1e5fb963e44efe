"""Estimates far from where they began, of a model that simulates badly: no number of the machine, however small their deviations are."""

from __future__ import annotations

import math

from greybox_torch.api.estimated import estimated_parameters
from greybox_torch.api.ran_away import away, by_one_factor, start_values, told_with_start
from greybox_torch.data import DataSet
from greybox_torch.estimate.descent import TRUSTED
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.metrics import told_fit
from greybox_torch.estimate.notes import at_bounds
from greybox_torch.name_lists import listed

FAR_TIMES = 10.0
"""Times its start value, or part of it, from which an estimate is far: what is guessed of a machine is seldom as far off."""


def far_parameters(found: Estimation, data: DataSet, fit: float) -> str | None:
    """A sentence where free parameters ended far from the values that they began with, and the estimate simulates badly; else None.

    Not of those that ran away, or ended at a bound, which is told elsewhere. Seen: a carriage of 271 kg, begun with 8, and a belt of
    179 N/m, begun with 50000, of an axis whose dry friction was left out, without a word.

    Args:
        fit: mean fit in % with which the estimate simulates.
    """
    if fit >= TRUSTED:
        return None
    begun, entries = start_values(found, data), estimated_parameters(found)
    told_elsewhere = {*away(found, data, fit), *at_bounds(found.problem)}
    far = [
        name
        for name, one in entries.items()
        if not one.fixed
        and name not in told_elsewhere
        and one.value * begun[name] != 0.0
        and abs(math.log(abs(one.value / begun[name]))) >= math.log(FAR_TIMES)
    ]
    if not far:
        return None
    it = "it" if len(far) == 1 else "they"
    return (
        f"Ended far from where {it} began: {listed(told_with_start(found, data, far))}{by_one_factor(found, data, far)}. "
        f"With a mean fit of {told_fit(fit, 1)} {it} may make up for something that the model lacks or has wrong, and standard "
        "deviations do not say so. Fix what is known of the machine ({ value = …, fixed = true } in [model.parameters]); "
        "`greybox diagnose` looks for what is missing."
    )
