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


@dataclass(frozen=True)
class Percentage(InASentence):
    """A ``channel`` of unit "1" with values from ``low`` to ``high``."""

    channel: str
    low: float
    high: float
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        return (
            f'channel "{self.channel}": has the unit "1" and values from {self.low:.4g} to {self.high:.4g}, as of a share in percent '
            "(a count may be as large)"
        )


@dataclass(frozen=True)
class Fraction(InASentence):
    """A ``channel`` in percent with values from ``low`` to ``high``."""

    channel: str
    low: float
    high: float
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        return (
            f'channel "{self.channel}": has the unit "%" and values from {self.low:.4g} to {self.high:.4g}, as of a fraction of 1 '
            "(a share of one percent may be as small)"
        )


def percentages(data: DataSet) -> Iterator[Percentage | Fraction]:
    """The channels of a data set that look so, over all of its experiments, but those of which the card gives the scale."""
    scaled = _scaled(data)
    for name, channel in data.channels.items():
        if channel.unit not in ("1", "%") or name in scaled:
            continue
        values = np.concatenate([r.signals[name] for r in data.recordings if name in r.signals] or [np.empty(0)])
        known = values[np.isfinite(values)]
        low, high = (float(end) for end in (known.min(initial=np.inf), known.max(initial=-np.inf)))
        if channel.unit == "%":
            if _FRACTION[0] <= high <= _FRACTION[1] and low >= -_FRACTION[1]:
                line = f'{toml_key(name)} = {{ …, file_unit = "1" }} if so, or scale = 1.0 in its line if it is none'
                yield Fraction(name, low, high, line if data.path else "values multiplied by 100 if so")
            continue
        if NEAR_ALL <= high <= ALL and low >= -ALL:
            line = f'{toml_key(name)} = {{ …, file_unit = "%" }} if so, or scale = 1.0 in its line if it is none'
            write = line if data.path else "values divided by 100 if so"
            yield Percentage(name, low, high, write)


def _scaled(data: DataSet) -> set[str]:
    """The channels whose factor or file's unit the card gives, in [channels] or for an experiment: somebody has thought of the unit."""
    card = card_at(data.path)
    cards = [card, *(card.of(experiment) for experiment in card.experiment)] if card else []
    said = {"scale", "file_unit"}
    return {name for one in cards for name, entry in one.channels.items() if said & entry.model_fields_set}
