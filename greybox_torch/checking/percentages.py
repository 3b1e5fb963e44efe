"""Channels of unit "1" whose values are those of a share in percent: a free gain makes up for the hundred, so that no fit tells."""

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


def percentages(data: DataSet) -> Iterator[Percentage]:
    """The channels of a data set that look so, over all of its experiments, but those of which the card gives the scale."""
    scaled = _scaled(data)
    for name, channel in data.channels.items():
        if channel.unit != "1" or name in scaled:
            continue
        values = np.concatenate([r.signals[name] for r in data.recordings if name in r.signals] or [np.empty(0)])
        known = values[np.isfinite(values)]
        low, high = (float(end) for end in (known.min(initial=np.inf), known.max(initial=-np.inf)))
        if NEAR_ALL <= high <= ALL and low >= -ALL:
            line = f'{toml_key(name)} = {{ …, file_unit = "%" }} if so, or scale = 1.0 in its line if it is none'
            write = line if data.path else "values divided by 100 if so"
            yield Percentage(name, low, high, write)


def _scaled(data: DataSet) -> set[str]:
    """The channels of which somebody gave the factor, in [channels] or for an experiment, and so has thought of the unit."""
    card = card_at(data.path)
    cards = [card, *(card.of(experiment) for experiment in card.experiment)] if card else []
    return {name for one in cards for name, entry in one.channels.items() if "scale" in entry.model_fields_set}
