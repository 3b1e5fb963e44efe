"""Channels of unit "1" whose values are those of a share in percent, and the other way round: a free gain makes up for the hundred, so that
no fit tells.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.data.card import card_at
from greybox_torch.data.data_warning import InASentence
from greybox_torch.files import toml_key

NEAR_ALL, ALL = 50.0, 100.5
"""Between which the largest value lies; beyond it is no percentage, and of a few a count or a ratio has as many."""
_FRACTION = 0.1, 1.0
"""Between which the largest value of a fraction lies that is taken for percent."""
_ALIKE = {
    "%": "as of a share in percent (a count may be as large)",
    "1": "as of a fraction of 1 (a share of one percent may be as small)",
}
"""By the unit that is meant, what the values look like, and what they may be instead."""
_MEANT = {"1": ("%", NEAR_ALL, ALL, "divided"), "%": ("1", *_FRACTION, "multiplied")}
"""By the unit of a channel: the one that is meant where the largest value lies between two, and what values from memory are by 100."""


@dataclass(frozen=True)
class OtherShare(InASentence):
    """A ``channel`` with values from ``low`` to ``high`` that are those of a share in the ``other`` unit, "1" or "%", than its ``unit``."""

    channel: str
    unit: str
    low: float
    high: float
    other: str
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        alike = _ALIKE[self.other]
        return f'channel "{self.channel}": has the unit "{self.unit}" and values from {self.low:.4g} to {self.high:.4g}, {alike}'


def percentages(data: DataSet) -> Iterator[OtherShare]:
    """The channels of a data set that look so, over all of its experiments, but those of which the card gives the scale."""
    scaled = _scaled(data)
    for name, channel in data.channels.items():
        if channel.unit not in _MEANT or name in scaled:
            continue
        other, least, most, done = _MEANT[channel.unit]
        values = np.concatenate([r.signals[name] for r in data.recordings if name in r.signals] or [np.empty(0)])
        known = values[np.isfinite(values)]
        low, high = (float(end) for end in (known.min(initial=np.inf), known.max(initial=-np.inf)))
        if least <= high <= most and low >= -most:
            line = f'{toml_key(name)} = {{ …, file_unit = "{other}" }} if so, or scale = 1.0 in its line if it is none'
            write = line if data.path else f"values {done} by 100 if so"
            yield OtherShare(name, channel.unit, low, high, other, write)


def _scaled(data: DataSet) -> set[str]:
    """The channels whose factor or file's unit the card gives, in [channels] or for an experiment: somebody has thought of the unit."""
    card = card_at(data.path)
    cards = [card, *(card.of(experiment) for experiment in card.experiment)] if card else []
    said = {"scale", "file_unit"}
    return {name for one in cards for name, entry in one.channels.items() if said & entry.model_fields_set}
