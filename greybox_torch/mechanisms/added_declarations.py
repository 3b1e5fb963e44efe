"""What attachments add to a model's declarations: states, inputs and parameters."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.delayed_input import channels
from greybox_torch.mechanisms.local_signals import LocalSignals
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings
from greybox_torch.model import Body, GreyBoxModel, Input, Parameter, State
from greybox_torch.model.unit_of_rate import unit_of_integral
from greybox_torch.model.unit_of_signal import unit_of_signal


def added_states(local: LocalSignals) -> list[State]:
    """Positions and time where mechanisms need them and a layer before has none, then the mechanisms' memory."""
    there = {s.name for s in local.base.states} - {s.name for s in local.base.plain.states}
    positions = [
        State(f"{n}.position", position_unit(local.base, local.body(n)), 0.0, fixed=True)
        for n in local.integrated_bodies()
    ]
    time = [State("time", "s", 0.0, fixed=True)] if local.need("time") else []
    memory = [
        replace(s, name=f"{a.prefix}.{s.name}")
        for a in local.attachments
        for s in a.mechanism.states(local.surroundings[a.port])
    ]
    return [*(s for s in (*positions, *time) if s.name not in there), *memory]


def added_inputs(attachments: Sequence[Attachment]) -> list[Input]:
    """The channels of delayed inputs: value at the present delay, slope, and that delay."""
    delays = [a for a in attachments if "delayed" in a.mechanism.needs]
    return [Input(f"{a.prefix}.{n}") for a in delays for names in channels(a.mechanism) for n in names]


def added_parameters(
    attachments: Sequence[Attachment], surroundings: Mapping[str, Surroundings], probed: Collection[str]
) -> list[Parameter]:
    """The mechanisms' parameters as ``PORT.MECHANISM.PARAMETER``, with a factor on the whole effect where its prefix is ``probed``."""
    result = []
    for a in attachments:
        result += [replace(q, name=f"{a.prefix}.{q.name}") for q in a.mechanism.parameters(surroundings[a.port])]
        if a.prefix in probed:
            result.append(Parameter(f"{a.prefix}.{SHARE}", 1.0))
    return result


def started_at(parameter: Parameter, start: Mapping[str, float]) -> Parameter:
    """The parameter with its value from ``start``, if it is there, held within its bounds."""
    if parameter.name not in start:
        return parameter
    low, high = parameter.bounds
    return replace(parameter, value=float(np.clip(start[parameter.name], low, high)))


def position_unit(model: GreyBoxModel, body: Body) -> str:
    """The unit of a body's position, as its states tell; where they do not, that of its speed's integral over time."""
    shown = "" if body.position is None else unit_of_signal(model, body.position)
    return shown or unit_of_integral(unit_of_signal(model, body.speed))
