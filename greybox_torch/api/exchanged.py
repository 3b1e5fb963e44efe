"""Whether channels may be exchanged, or one has the other sign: asked where an estimate simulates the validation experiments badly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, product

import numpy as np

from greybox_torch.api.short_refits import REFITTED, Asked, Change, asked_of, beginnings, far_better, fit_after
from greybox_torch.data import DataSet
from greybox_torch.data.card import card_at
from greybox_torch.model import GreyBoxModel
from greybox_torch.name_lists import listed
from greybox_torch.simulation.simulator import Simulator

MOST_ALIKE = 28
"""Exchanges among inputs, among outputs, or of one with the other that are simulated, and channels of other sign: the pairs of eight. More
are not asked for.
"""

COLUMNS_OR_SCALE = "the card's columns or scale"
"""What is to be mended where a column or a sign is wrong."""


def exchanged(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """A question to the user, where exchanging two channels of one unit, or reversing the sign of one, makes a short refit far better on
    the validation experiments than these are as they stand; else None.

    None as well where a channel's first sample lies behind what a short refit takes, so that there is nothing to refit.

    Args:
        simulator: of the model, with tangents for its free parameters.
        achieved: the mean fit in % on the validation experiments of the estimate itself; may be minus infinity.
    """
    return _asked_of_best(data, model, simulator, achieved, list(_changes(model)))


def exchanged_of_other_units(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """The question for the columns of two inputs or two outputs of different units, each with the scale that the card gives the channel.

    Arguments as for :func:`exchanged`.
    """
    return _asked_of_best(data, model, simulator, achieved, list(_of_other_units(data, model)))


def _asked_of_best(
    data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float, changes: Sequence[Change]
) -> Asked | None:
    """The question of one of the ``changes``, of those that simulate best with the start values."""
    short = beginnings(data)
    if short is None:
        return None
    tried = nearest(short, model, simulator, changes)
    return asked_of(tried, far_better(short, model, simulator, tried, achieved), data, COLUMNS_OR_SCALE)


def nearest(short: DataSet, model: GreyBoxModel, simulator: Simulator, changes: Sequence[Change]) -> list[Change]:
    """Those of the ``changes``, a few, that simulate best with the start values, in their order."""
    by_start = {k: fit_after(short, model, simulator, change, refitted=False) for k, change in enumerate(changes)}
    return [changes[k] for k in sorted(sorted(by_start, key=lambda k: -by_start[k])[:REFITTED])]


def _of_other_units(data: DataSet, model: GreyBoxModel) -> Iterator[Change]:
    """Not of channels of which an experiment has a factor of its own: there is no one ratio then."""
    own = _converted_by_experiments(data)
    for signals in (model.inputs, model.outputs):
        pairs = [
            pair for pair in combinations(signals, 2) if all(s.unit for s in pair) and pair[0].unit != pair[1].unit
        ]
        for pair in pairs if len(pairs) <= MOST_ALIKE else ():
            one, other = (signal.name for signal in pair)
            ratio = data.channels[one].factor / data.channels[other].factor
            if np.isfinite(ratio) and not own & {one, other}:
                question = f"are the columns of {listed([one, other])} exchanged"
                yield Change({one: other, other: one}, question, factors={one: ratio, other: 1.0 / ratio})


def _converted_by_experiments(data: DataSet) -> set[str]:
    """The channels that an experiment on the card converts otherwise than [channels] does."""
    card = card_at(data.path)
    own = [item for experiment in (card.experiment if card else ()) for item in experiment.columns.items()]
    return {name for name, column in own if (column.expr, column.scale, column.file_unit) != (None, None, None)}


def _changes(model: GreyBoxModel) -> Iterator[Change]:
    """Exchanges first: of two that fit alike, they are the likelier slip."""
    inputs, outputs = model.inputs, model.outputs
    for signals in (combinations(inputs, 2), combinations(outputs, 2), product(inputs, outputs)):
        pairs = [(one.name, other.name) for one, other in signals if one.unit and one.unit == other.unit]
        for one, other in pairs if len(pairs) <= MOST_ALIKE else ():
            yield Change({one: other, other: one}, f"are the columns of {listed([one, other])} exchanged")
    yield from sign_turns(model)


def sign_turns(model: GreyBoxModel) -> Iterator[Change]:
    """The sign of each input and output turned."""
    for signals in (model.inputs, model.outputs):
        for signal in signals if len(signals) <= MOST_ALIKE else ():
            yield Change({signal.name: signal.name}, f"is the sign of {signal.name} turned", -1.0)
