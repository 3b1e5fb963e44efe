"""States as the recordings show them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.errors import check_none
from greybox_torch.files import toml_key
from greybox_torch.model import GreyBoxModel, State
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.simulation.records import Records


def measured_at(model: GreyBoxModel, state: State, records: Records, samples: np.ndarray) -> np.ndarray:
    """The measured value of a state at some samples (W,), or where that is missing the next known one; NaN where none is known at all.

    Raises:
        UserError: no signal measures the state, see :class:`State`.
    """
    values = _measured(model, state, records)
    known = np.flatnonzero(~np.isnan(values))
    if not known.size:  # the beginning of an experiment, before a sensor has come to life
        return np.full(len(samples), np.nan)
    return values[known[np.minimum(np.searchsorted(known, samples), len(known) - 1)]]


def measuring_signal(model: GreyBoxModel, state: State) -> str | None:
    """The output or input that measures a state: an output that shows it, or else the only output, or where none is the only input, in
    its unit. None where that does not tell.
    """
    shown = sensed_states(model).get(state.name)
    if shown is not None:
        return shown
    for signals in (model.outputs, model.inputs):
        same = [signal.name for signal in signals if signal.unit == state.unit]
        if same:
            return same[0] if len(same) == 1 else None
    return None


def not_measured(model: GreyBoxModel, state: State) -> tuple[str, str]:
    """Of a state that begins as measured and that no signal measures: what was found, and what is expected."""
    unit = state.unit or "1"
    outputs = ", ".join(f"{o.name} in {o.unit or '1'}" for o in model.outputs)
    return (
        f"state '{state.name}': initial is \"measured\", but no output is this state, and there is not exactly one output or input in its "
        f"unit {unit}; the outputs are {outputs or 'none'}",
        f"an output that is this state, exactly one output or input in {unit}, or a number to begin with (initial=0.0 in the model, or "
        f"{toml_key(state.name)} = {{ value = 0.0 }} under [model.initial] of the card)",
    )


def check_measured(model: GreyBoxModel, states: Sequence[State]) -> None:
    """Raises UserError, for all of them at once, where no signal measures one of the ``states``."""
    problems = [
        "; expected ".join(not_measured(model, state)) for state in states if measuring_signal(model, state) is None
    ]
    check_none(problems, f"model {model.title}", before_one=", ")


def _measured(model: GreyBoxModel, state: State, records: Records) -> np.ndarray:
    check_measured(model, [state])
    name = measuring_signal(model, state)
    outputs = [o.name for o in model.outputs]
    return (
        records.y[outputs.index(name)]
        if name in outputs
        else records.u[[i.name for i in model.inputs].index(str(name))]
    )
