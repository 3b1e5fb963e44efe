"""Channels that are 57.3, 100 or 1000 times as large in some experiments as in others, as where two files have other units."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.data.card import Card, card_at
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.files import toml_key, toml_text
from greybox_torch.in_unit import in_unit
from greybox_torch.name_lists import brief

_FACTORS = (180.0 / math.pi, 100.0, 1000.0)
_NEAR = 1.2
"""By how much a ratio may differ from such a factor."""
_ALIKE = 3.0
"""By how much experiments in one unit may differ, the largest over the smallest."""
_DIFFERENT = 4
"""Values that a channel has at least where it moves; a valve that is open or closed moves by what was set."""


@dataclass(frozen=True)
class _Size:
    low: float
    high: float
    largest: float
    rms: float


@dataclass(frozen=True)
class OtherUnits(InASentence):
    """A ``channel`` of which the ``small`` experiments have ``factor`` times less than the ``large`` ones."""

    found: str
    write: str


def other_units(data: DataSet) -> Iterator[OtherUnits]:
    """The channels of which some experiments are likely in other units than others: those that are so much smaller while other channels
    are not, as they would be in an experiment of small amplitudes.
    """
    card = card_at(data.path)
    sizes = {name: found for name in data.channels if len(found := _sizes(data, name)) > 1}
    for name, of in sizes.items():
        small, large = _two_groups(of)
        factor = _factor([of[n] for n in small], [of[n] for n in large]) if small else None
        if factor is None or _scaled(card, name, of):
            continue
        others = [other for other in sizes if other != name]
        smaller = [other for other in others if _ratio(sizes[other], small, large) > math.sqrt(factor)]
        if others and len(smaller) < len(others):
            yield _told(data, card, name, of, small, large, factor)


def _sizes(data: DataSet, name: str) -> dict[str, _Size]:
    """By experiment, of those in which the channel moves; none where it rests in one."""
    of: dict[str, list[np.ndarray]] = {}
    for recording in data.recordings:
        if name in recording.signals:
            values = recording.measured(name)
            of.setdefault(recording.name.removesuffix(HELD_OUT), []).append(values[np.isfinite(values)])
    found: dict[str, _Size] = {}
    for experiment, parts in of.items():
        values = np.concatenate(parts)
        if len(np.unique(values)) < _DIFFERENT:
            return {}
        rms = float(np.sqrt(np.mean(values**2)))
        found[experiment] = _Size(float(values.min()), float(values.max()), float(np.abs(values).max()), rms)
    return found


def _two_groups(of: Mapping[str, _Size]) -> tuple[list[str], list[str]]:
    """The experiments before and after the largest leap of their largest values; none where they do not lie in two such groups."""
    names = sorted(of, key=lambda name: of[name].largest)
    largest = [of[name].largest for name in names]
    leaps = [later / earlier for earlier, later in pairwise(largest)]
    split = int(np.argmax(leaps)) + 1
    within = max(largest[split - 1] / largest[0], largest[-1] / largest[split])
    return (names[:split], names[split:]) if within <= _ALIKE else ([], [])


def _factor(small: Sequence[_Size], large: Sequence[_Size]) -> float | None:
    """The one of _FACTORS between two groups of experiments, by their largest values and by their rms; None where it is none."""
    ratios = [_mean(large, key) / _mean(small, key) for key in ("largest", "rms")]
    near = (f for f in _FACTORS if all(1.0 / _NEAR <= ratio / f <= _NEAR for ratio in ratios))
    return next(near, None)


def _ratio(of: Mapping[str, _Size], small: Sequence[str], large: Sequence[str]) -> float:
    """Of another channel between the same experiments; one where it is not in both."""
    ends = [[of[name] for name in names if name in of] for names in (small, large)]
    return _mean(ends[1], "rms") / _mean(ends[0], "rms") if all(ends) else 1.0


def _mean(sizes: Sequence[_Size], key: str) -> float:
    return math.exp(sum(math.log(getattr(size, key)) for size in sizes) / len(sizes))


def _scaled(card: Card | None, name: str, of: Mapping[str, _Size]) -> bool:
    """Whether the card gives an experiment's own factor or unit, so that somebody has thought of it."""
    own = [e.columns[name] for e in card.experiment if e.name in of and name in e.columns] if card else []
    return any(column.scale is not None or column.file_unit is not None for column in own)


def _told(
    data: DataSet,
    card: Card | None,
    name: str,
    of: Mapping[str, _Size],
    small: Sequence[str],
    large: Sequence[str],
    factor: float,
) -> OtherUnits:
    unit = data.channels[name].unit
    ends = [
        (min(of[one].low for one in names), max(of[one].high for one in names), brief([f'"{one}"' for one in names]))
        for names in (small, large)
    ]
    ranges = [f"{in_unit(f'{low:.3g} … {high:.3g}', unit)} in {names}" for low, high, names in ends]
    found = f'channel "{name}": {" and ".join(ranges)}, about {factor:.4g} times as much, as where one of them is in other units'
    # shares in percent and angles in degrees are the larger ones
    wrong_large = unit in ("1", "rad", "rad/s", "m", "m/s") or (
        unit not in ("%", "deg", "deg/s", "mm") and len(large) < len(small)
    )
    wrong, scale = (large, 1.0 / factor) if wrong_large else (small, factor)
    entries = [e for e in card.experiment if e.name in wrong] if card else []
    entry = card.of(entries[0]).channels.get(name) if card and entries else None
    if entry is None or entry.file_unit is not None:
        return OtherUnits(found, f"values of {brief(wrong)} times {scale:.4g} if so")
    source = f"expr = {toml_text(entry.expr)}" if entry.expr else f"column = {toml_text(entry.column or '…')}"
    line = f"columns = {{ {toml_key(name)} = {{ {source}, scale = {scale * entry.scale:.6g} }} }}"
    where = brief([f'"{one}"' for one in wrong])
    return OtherUnits(found, f"{line} in [[experiment]] {where} if so; with scale = {entry.scale:g} there if not")
