"""Inputs that act a dead time later, for models that are simulated step by step.

Where recordings are simulated, all that was put in is known beforehand, and an input of before is one more channel. What is exported has to
remember it: the inputs of the times that it was called at, straight between them, and before the first of them as at the first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from greybox_torch.codegen.lower import Equations, with_replaced
from greybox_torch.errors import UserError
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.delayed_input import CHANNELS
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.ports import Actuator


@dataclass(frozen=True)
class Delay:
    """An input, by its place, that acts later by a parameter, by its place, of at most ``longest`` s; ``sample_time`` in s is that of
    the recordings that it was found in.
    """

    input: int
    parameter: int
    longest: float
    sample_time: float


def delays_of(model: GreyBoxModel) -> tuple[Delay, ...]:
    """Those of the attached effects, in their order.

    Raises:
        UserError: a dead time without an upper bound, for which no memory is long enough.
    """
    if not isinstance(model, AugmentedModel):
        return ()
    places = {p.name: k for k, p in enumerate(model.declared_parameters)}
    inputs = [i.name for i in model.base.inputs]
    found = []
    for a in (a for a in model.attachments if "delayed" in a.mechanism.needs):
        site = model.local.ports[a.port]
        assert isinstance(site, Actuator)
        name = model.parameter_name(a, "T")
        longest = model.declared_parameters[places[name]].bounds[1]
        if longest == float("inf"):
            raise UserError(
                f"model {model.title}: the dead time {name} has no upper bound, so nothing says how much of the past to keep; "
                "expected one in the mechanism's Parameter"
            )
        step = model.surroundings[a.port].sample_time
        found += [Delay(inputs.index(i), places[name], longest, step) for i in (site.input, *a.mechanism.drives)]
    return tuple(found)


def with_delays(equations: Equations, inputs: int, delays: int) -> Equations:
    """The equations with one input for each delay, after the model's own, in the place of the three that an effect has."""
    if not delays:
        return equations
    graph, zero = equations.graph, equations.graph.constant(0.0)
    other = {}
    for k in range(delays):
        value, slope = (graph.leaf("u", inputs + len(CHANNELS) * k + j) for j in (0, 1))
        other |= {value: graph.leaf("u", inputs + k), slope: zero}
    roots = (*equations.rates, *equations.outputs)
    place = with_replaced(graph, roots, other)
    return replace(
        equations,
        n_inputs=inputs + delays,
        rates=tuple(place[n] for n in equations.rates),
        outputs=tuple(place[n] for n in equations.outputs),
    )
