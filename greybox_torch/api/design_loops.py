"""The controller of a designed recording, from what the card or an argument says of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from greybox_torch.data import DataSet
from greybox_torch.data.card_controller import LoopEntry
from greybox_torch.data.given_loops import loops_of
from greybox_torch.experiment_design.controller import Loop
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.driven_inputs import check_controller


def entries_of(data: DataSet, given: Mapping[str, Any] | None, model: GreyBoxModel) -> dict[str, LoopEntry]:
    """The loops that are ``given`` by input, else those of the data set, which were checked when it was made.

    Raises:
        UserError: an entry is at fault, or names what the model does not have.
    """
    if given is None:
        check_controller(data.controller, model, data.place("[controller]"))
        return data.controller
    loops = loops_of(given, data.channels, data.hold, "design")
    check_controller(loops, model, "design, controller:")
    return loops


def loops_for(entries: Mapping[str, LoopEntry], model: GreyBoxModel, limits: Limits, step: float) -> tuple[Loop, ...]:
    """The loops of a model's inputs, clipped to their limits, with the sample time ``step`` in s."""
    inputs, outputs = [i.name for i in model.inputs], [o.name for o in model.outputs]
    return tuple(
        Loop(
            driven=inputs.index(name),
            measured=outputs.index(own.measured),
            lower=limits.inputs[name].lower,
            upper=limits.inputs[name].upper,
            step=step,
            gain=own.gain,
            integral=own.integral,
            derivative=own.derivative,
            offset=own.offset,
            delay=own.delay,
        )
        for name, own in entries.items()
    )
