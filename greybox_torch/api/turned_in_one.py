"""Whether a channel has the other sign in one experiment alone: asked where an estimate simulates the validation experiments badly.

Seen: a current whose sensor was mounted the other way round in one of three recordings; a gain of another sensor was told, and taken back.
"""

from __future__ import annotations

from collections.abc import Iterator

from greybox_torch.api.short_refits import (
    FAR_BETTER,
    FOLLOWS,
    REFITTED,
    Asked,
    Change,
    asked_of,
    beginnings,
    far_better,
    fit_after,
)
from greybox_torch.data import DataSet
from greybox_torch.data.holding_out import by_experiment
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import Simulator

MOST = 60
"""Channels times experiments up to which it is asked: as many simulations."""


def turned_in_one(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """A question to the user, where turning the sign of one channel in one experiment makes a short refit far better on the validation
    experiments than these are as they stand; else None. Only changes are refitted with which the start values alone simulate that
    experiment far better.

    Arguments as for :func:`greybox_torch.api.exchanged.exchanged`.
    """
    short = beginnings(data)
    changes = [] if short is None else list(_changes(short, model))
    if short is None or not 0 < len(changes) <= MOST:
        return None
    lefts = {k: 100.0 - fit_after(short, model, simulator, c, refitted=False) for k, c in enumerate(changes)}
    as_begun = {
        names: 100.0 - fit_after(short, model, simulator, Change({}, "", only=names), refitted=False)
        for names in {change.only for change in changes}
    }
    better = [k for k, left in lefts.items() if left < min(FAR_BETTER * as_begun[changes[k].only], 100.0 - FOLLOWS)]
    tried = [changes[k] for k in sorted(sorted(better, key=lambda k: lefts[k])[:REFITTED])]
    found = far_better(short, model, simulator, tried, achieved) if tried else None
    return asked_of(tried, found, data, "the values of that channel in its file")


def _changes(data: DataSet, model: GreyBoxModel) -> Iterator[Change]:
    experiments = by_experiment(data.recordings, held_out_by_default=data.held_out_by_default)
    for experiment, names in experiments.items() if len(experiments) > 1 else ():
        for signal in (*model.inputs, *model.outputs):
            question = f"is the sign of {signal.name} turned in {experiment} alone"
            yield Change({signal.name: signal.name}, question, -1.0, names)
