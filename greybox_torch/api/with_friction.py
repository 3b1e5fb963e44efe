"""Whether a channel has the other sign, or another unit, on a machine with dry friction that the model lacks: asked where an estimate
follows nothing.

Without the friction neither sign nor unit fits, so that no change makes the fit far better. Seen: a conveyor's torque of the other sign; an
axis' motor speed in rpm, read as rad/s.
"""

from __future__ import annotations

from greybox_torch.api.exchanged import COLUMNS_OR_SCALE, nearest, sign_turns
from greybox_torch.api.rescaled import asked_of_scale, of_units
from greybox_torch.api.short_refits import (
    AS_IT_IS,
    FOLLOWS,
    Asked,
    as_it_is,
    asked_of,
    beginnings,
    far_better,
    fit_after,
)
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

MOST_UNITS = 12
"""Changes of units up to which it is asked: each is refitted, as start values without the friction do not say which is nearer."""


def changed_with_friction(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """A question to the user, where turning the sign of one channel, with Coulomb friction at every body, makes a short refit far better on
    the validation experiments than both the estimate and a refit with the friction alone, or, where none does, values of one channel by a
    factor that units differ by, if that explains more than the friction alone; else None. Of decades no refit is made: they are many.

    Arguments as for :func:`greybox_torch.api.exchanged.exchanged`.
    """
    short = beginnings(data)
    made = None if short is None or achieved >= FOLLOWS else _rubbing(short, model, simulator)
    if short is None or made is None:
        return None
    rubbing, own = made
    without, achieved = achieved, as_it_is(short, rubbing, own, achieved)
    turns = nearest(short, rubbing, own, list(sign_turns(model)))
    found = far_better(short, rubbing, own, turns, achieved, refitted=True)
    if found is not None:
        return asked_of(turns, found, data, COLUMNS_OR_SCALE, f"So changed, and {_with(model)}")
    changes = list(of_units(model))
    single = [change for change in changes if len(change.read) == 1]
    units = next((some for some in (changes, single) if len(some) <= MOST_UNITS), [])
    found = far_better(short, rubbing, own, units, achieved, refitted=True)
    if found is None:
        return None
    left, lefts = found
    best = lefts.index(min(lefts))
    of_friction = min(100.0, 100.0 - without) - left  # a constant leaves 100
    if left - lefts[best] <= of_friction:
        return None
    return asked_of_scale(units[best], left, lefts[best], data, f", and {_with(model)}")


def friction_explains_more(data: DataSet, model: GreyBoxModel, simulator: Simulator, reached: float) -> bool:
    """Whether Coulomb friction at every body by itself lets a short refit reach as large a mean fit in % on the validation experiments as
    was ``reached`` with a channel changed: then the model lacks that, and a change of the channel makes up for a part of it.
    """
    short = beginnings(data)
    made = None if short is None else _rubbing(short, model, simulator)
    return short is not None and made is not None and fit_after(short, *made, AS_IT_IS) >= reached


def _rubbing(short: DataSet, model: GreyBoxModel, simulator: Simulator) -> tuple[AugmentedModel, Simulator] | None:
    """The model with Coulomb friction at every body, and a simulator of it; None where it is not asked."""
    bodies = _bodies(model)
    if not 0 < len(bodies) <= MOST_BODIES:
        return None
    try:
        around = survey(model, make_problem(short, model, short.estimation()), simulator)
        rubbing = AugmentedModel(model, [attach(model, name, CoulombFriction()) for name in bodies], around)
        return rubbing, simulator_for(make_problem(short, rubbing, short.estimation()), simulator.options)
    except (NumericalError, UserError):  # a simulation that overflows says nothing of how fast the bodies are
        return None


def _bodies(model: GreyBoxModel) -> list[str]:
    return [port.name for port in model.all_ports if isinstance(port, Body)]


def _with(model: GreyBoxModel) -> str:
    return f"with Coulomb friction at {listed(_bodies(model))}"
