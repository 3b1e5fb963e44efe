"""States as the recordings show them."""

from __future__ import annotations

import numpy as np

from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel, State
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.simulation.records import Records


def measured_at(model: GreyBoxModel, state: State, records: Records, samples: np.ndarray) -> np.ndarray:
    """The measured value of a state at some samples (W,), or where that is missing the next known one; NaN where none is known at all.

    Raises:
        UserError: no signal measures the state, see :class:`State`.
    """
    values = _measuring_signal(model, state, records)
    known = np.flatnonzero(~np.isnan(values))
    if not known.size:  # the beginning of an experiment, before a sensor has come to life
        return np.full(len(samples), np.nan)
    return values[known[np.minimum(np.searchsorted(known, samples), len(known) - 1)]]


def _measuring_signal(model: GreyBoxModel, state: State, records: Records) -> np.ndarray:
    shown = sensed_states(model).get(state.name)
    if shown is not None:
        return records.y[[o.name for o in model.outputs].index(shown)]
    for signals, rows in ((model.outputs, records.y), (model.inputs, records.u)):
        same = [i for i, signal in enumerate(signals) if signal.unit == state.unit]
        if len(same) == 1:
            return rows[same[0]]
        if len(same) > 1:
            break
    raise UserError(
        f"model {model.title}, state '{state.name}': initial is 'measured', but no output shows it and not exactly one output or input is "
        f"in '{state.unit}'; expected an output that is this state, exactly one signal in the same unit, or a number to begin with "
        "(initial=0.0)"
    )
