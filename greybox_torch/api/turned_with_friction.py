"""Whether a channel has the other sign on a machine with dry friction that the model lacks: asked where an estimate follows nothing.

Without the friction neither sign fits, so that no turned channel makes the fit far better. Seen: a conveyor's torque of the other sign.
"""

from __future__ import annotations

from greybox_torch.api.exchanged import asked_of_best, sign_turns
from greybox_torch.api.short_refits import FOLLOWS, Asked, beginnings
from greybox_torch.data import DataSet
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.estimate.surroundings import survey
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.ports import Body
from greybox_torch.name_lists import listed
from greybox_torch.simulation.simulator import Simulator

MOST_BODIES = 4
"""Bodies of a model up to which it is asked: each has a level of friction to be estimated."""


def turned_with_friction(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """A question to the user, where turning the sign of one channel, with Coulomb friction at every body, makes a short refit far better on
    the validation experiments than both the estimate and a refit with the friction alone; else None.

    Arguments as for :func:`greybox_torch.api.exchanged.exchanged`.
    """
    bodies, short = [p.name for p in model.all_ports if isinstance(p, Body)], beginnings(data)
    if short is None or achieved >= FOLLOWS or not 0 < len(bodies) <= MOST_BODIES:
        return None
    try:
        around = survey(model, make_problem(short, model, short.estimation()), simulator)
        rubbing = AugmentedModel(model, [attach(model, name, CoulombFriction()) for name in bodies], around)
        made = simulator_for(make_problem(short, rubbing, short.estimation()), simulator.options)
    except (NumericalError, UserError):  # a simulation that overflows says nothing of how fast the bodies are
        return None
    so = f"So changed, and with Coulomb friction at {listed(bodies)}"
    return asked_of_best(data, rubbing, made, achieved, list(sign_turns(model)), so)
