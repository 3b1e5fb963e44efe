"""What a model with delayed inputs needs beside the equations in C: the memory of what was put in, and where it is asked."""

from __future__ import annotations

import math

from greybox_torch.exporting.delays import Delay
from greybox_torch.exporting.exported import ExportedModel
from greybox_torch.exporting.fill import filled

FINER = 0.5
"""Samples nearer than which times are not all kept: so the memory has an end, however small a client's steps are."""
_PLACES = (
    "KEPT",
    "STRING",
    "DELAYED",
    "PAST",
    "PAST_CODE",
    "PAST_VARIABLE",
    "PAST_MEMBER",
    "RECALL_NOW",
    "RECALL_NEXT",
    "RECALL_OUTPUTS",
    "RECALL_START",
    "RECALL_END",
)


def delay_places(model: ExportedModel) -> dict[str, object]:
    """The places of the templates that are empty in a model without delays."""
    if not model.delays:
        return dict.fromkeys(_PLACES, "")
    name, count = model.identifier, len(model.inputs)
    own = {
        "name": name,
        "NAME": name.upper(),
        "NU": count,
        "DELAYS": "\n".join(_told(model, count + k, delay) for k, delay in enumerate(model.delays)),
        "LONGEST": repr(max(delay.longest for delay in model.delays)),
        "FINEST": repr(FINER * min(delay.sample_time for delay in model.delays)),
        "SAMPLES": _room(model.delays),
        "RECALLED": "\n".join(
            f"    u[{count + k}] = was(past, {delay.input}, time - limited(p[{delay.parameter}]));"
            for k, delay in enumerate(model.delays)
        ),
    }
    straight = model.hold == "foh"
    return {
        "KEPT": f" but in {name}_past",
        "STRING": "#include <string.h>\n",
        "DELAYED": "".join(
            f"/*   u[{count + k}]  {model.inputs[delay.input].name} as it was before, see {name}_recall */\n"
            for k, delay in enumerate(model.delays)
        ),
        "PAST": filled("past.h", own),
        "PAST_CODE": filled("past.c", own),
        "PAST_VARIABLE": f"static {name}_past past;\n\n",
        "PAST_MEMBER": f"    {name}_past past;\n",
        "RECALL_NOW": f"        {name}_recall(&past, p, now[0], now + 1);\n",
        "RECALL_NEXT": f"            {name}_recall(&past, p, next[0], next + 1);\n" if straight else "",
        "RECALL_OUTPUTS": f"{name}_recall(&self->past, self->p, self->time, self->u);\n        ",
        "RECALL_START": f"    {name}_recall(&self->past, self->p, now, self->u);\n",
        "RECALL_END": f"    {name}_recall(&self->past, self->p, now + dt, end);\n" if straight else "",
    }


def _told(model: ExportedModel, place: int, delay: Delay) -> str:
    """A line of the header's comment."""
    parameter = model.parameters[delay.parameter]
    return f" * u[{place}] is {model.inputs[delay.input].name}, p[{delay.parameter}] s later ({parameter.name})"


def _room(delays: tuple[Delay, ...]) -> int:
    """Samples to keep: of any two intervals in a row one is longer than the finest; half as many again are dropped at once."""
    needed = 2.0 * max(d.longest for d in delays) / (FINER * min(d.sample_time for d in delays)) + 3.0
    return math.ceil(1.5 * needed)
