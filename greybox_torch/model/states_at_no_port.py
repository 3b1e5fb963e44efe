"""States that ports have no signal for: those between an actuator and a body (the current of a coil), and those that a sensor shows."""

from __future__ import annotations

from typing import Any

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.own_rate import balanced_state, without_laws
from greybox_torch.model.port_forces import no_forces
from greybox_torch.model.ports import Body, Sensor
from greybox_torch.model.states_of import inputs_of, states_of

STATE = "state@"
"""Beginning of the name of a signal that is a state of the model at none of its ports; the state's name follows."""


def driving_states(model: GreyBoxModel, body: Body) -> list[str]:
    """The states that move a body's rate and are no port's own: neither its position, speed, deflection nor level depends on them."""
    if balanced_state(model, body) is None:
        return []
    own = (s for q in model.ports for name, s in q.signals.items() if name != "load")  # what a body carries is a force
    known = set().union(*(states_of(model, s) for s in own))
    moving = states_of(model, without_laws(model, body))
    return [s.name for s in model.states if s.name in moving - known]


def states_shown(model: GreyBoxModel, sensor: Sensor) -> list[str]:
    """The states that move what a sensor shows, where it shows more than one of them, or an input as well.

    Of a single one any curve is a curve over the output itself.
    """
    none = no_forces(model)

    def shown(x: Any, u: Any, p: Any) -> Any:
        return model.outputs_with(x, u, p, none)[sensor.output]

    moving = states_of(model, shown)
    return [s.name for s in model.states if s.name in moving] if len(moving) + len(inputs_of(model, shown)) > 1 else []
