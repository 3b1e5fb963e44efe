"""Which column is which input or output of a model: by name, by unit, and where that leaves two, by what is alike."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from greybox_torch.data.column_units import parts_of, without_ending
from greybox_torch.data.counts import is_angle, is_count, may_count, named_as_count
from greybox_torch.data.units import conversion
from greybox_torch.errors import UserError

_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")
_ALIKE = (
    {"speed", "velocity", "vel", "w", "v", "omega", "qd", "dq", "rpm", "n", "drehzahl", "geschwindigkeit", "vitesse"},
    {"position", "pos", "angle", "q", "theta", "phi", "x", "deg", "weg", "lage", "winkel", "displacement"},
    {"torque", "tau", "trq", "moment", "m", "u", "drehmoment", "couple"},
    {"force", "f", "u", "kraft"},
    {"voltage", "volt", "volts", "v", "u", "spannung", "tension"},
    {"current", "cur", "i", "amps", "u", "strom", "courant"},
    {"level", "height", "h", "y", "pegel", "niveau"},
    {"temperature", "temp", "t", "y", "temperatur"},
    {"pressure", "press", "p", "druck", "pression"},
    {"flow", "q", "inflow", "u", "durchfluss", "debit"},
    {"power", "p", "heat", "u", "leistung", "puissance"},
    {"acceleration", "acc", "a"},
    {"measured", "meas", "measurement", "actual", "act"},
)
"""Words of one meaning, in the languages of data logs."""

_LETTERS = ("A", "V", "W", "N", "K", "m")
"""Units of one letter that may end a name, if the channel is in such a unit: x_m is a length where one is wanted, else measured."""
_GRAVITY = "g"
"""Ends the names of accelerations in multiples of gravity."""

SURE = 0.5
"""Score from which a column is taken for a channel."""

_OF_ITS_PORT = 0.1
"""What a word of the port adds to the score: the temperature of a jacket is called after it sooner than after its letter."""

_ALIKE_FITTING = 0.05
"""Difference of scores up to which two columns fit alike."""


@dataclass(frozen=True)
class Wanted:
    """An input or output of the model; ``ports`` are those whose level, speed, position or deflection it is."""

    name: str
    unit: str
    is_input: bool
    ports: tuple[str, ...] = ()


def matched(wanted: Sequence[Wanted], columns: Sequence[str], units: Mapping[str, str]) -> dict[str, str]:
    """The column of each channel that one was found for, by the channel's name; no column twice, the surest first."""
    scores = sorted(
        (
            (-_score(channel, column, units.get(column, ""), wanted), k, i)
            for i, channel in enumerate(wanted)
            for k, column in enumerate(columns)
        ),
    )
    found: dict[str, str] = {}
    for negative, k, i in scores:
        if -negative >= SURE and wanted[i].name not in found and columns[k] not in found.values():
            found[wanted[i].name] = columns[k]
    return found | _only_ones_left(wanted, columns, units, found)


def also_fitting(
    wanted: Sequence[Wanted], columns: Sequence[str], units: Mapping[str, str], found: Mapping[str, str]
) -> dict[str, str]:
    """By channel another column whose name fits as well as the one that was ``found``: a free one, or one of another channel if the two can
    be exchanged.
    """
    of = {column: name for name, column in found.items()}
    scores = {
        (channel.name, column): _score(channel, column, units.get(column, ""), wanted)
        for channel in wanted
        for column in columns
    }
    alike: dict[str, str] = {}
    for name, own in found.items():
        for column in columns:
            other = of.get(column, "")
            least = scores[name, own] + (scores[other, column] if other else 0.0) - _ALIKE_FITTING
            instead = [scores[name, column], *([scores[other, own]] if other else [])]
            if column != own and min(instead) >= SURE and sum(instead) >= least:
                alike.setdefault(name, column)
    return alike


def _only_ones_left(
    wanted: Sequence[Wanted], columns: Sequence[str], units: Mapping[str, str], found: Mapping[str, str]
) -> dict[str, str]:
    """Channels for which one column alone is left whose unit fits, and which that column alone fits."""
    open_ones = [channel for channel in wanted if channel.name not in found and channel.unit]
    left = [column for column in columns if column not in found.values()]
    fitting = {ch.name: [c for c in left if _may_be(c, units.get(c, ""), ch.unit)] for ch in open_ones}
    return {
        name: mine[0]
        for name, mine in fitting.items()
        if len(mine) == 1 and units.get(mine[0]) and sum(mine[0] in others for others in fitting.values()) == 1
    }


def _may_be(column: str, unit: str, wanted: str) -> bool:
    """Whether a column's unit fits, or it holds counts that may be of the angle that is wanted."""
    counts = is_count(unit) or (not unit and named_as_count(column))
    return fits(unit, wanted) if unit and not counts else counts and may_count(unit, wanted)


def _score(channel: Wanted, column: str, unit: str, wanted: Sequence[Wanted]) -> float:
    """From 0 to 1.5: how well a column fits a channel."""
    if not unit and (unit := letter_unit(column, channel.unit)):
        column, _, _ = parts_of(column)
    one, other = channel.name.lower(), column.lower()
    if one == other:
        return 1.5
    mine, theirs = words(channel.name), words(column)
    if mine == theirs:
        return 1.4
    if not _numbers(mine):  # Position4 of the fourth joint may well be the position
        theirs = [word for word in theirs if not word.isdigit()]
    score = 0.6 * _overlap(mine, theirs) + 0.4 * SequenceMatcher(None, one, other).ratio()
    letter = without_ending(other)
    if letter in ("u", "y") and (letter == "u") == channel.is_input:
        alone = sum(w.is_input == channel.is_input for w in wanted) == 1
        score = max(score, 0.9 if alone else 0.0)
    if _numbers(mine) and _numbers(theirs) and _numbers(mine) != _numbers(theirs):
        score *= 0.3  # tau1 is not tau2
    if unit and channel.unit:
        score += 0.25 if fits(unit, channel.unit) else -0.4
    if any(set(theirs) & set(words(port)) for port in channel.ports):
        score += _OF_ITS_PORT
    return score


def letter_unit(column: str, wanted: str) -> str:
    """The unit that a letter at the end of a name stands for, if that is of the ``wanted`` unit's quantity; else ""."""
    _, _, letter = parts_of(column)
    if not letter or not wanted:
        return ""
    if letter == _GRAVITY:
        return "g0" if fits("g0", wanted) else ""
    return letter if letter in _LETTERS and fits(letter, wanted) else ""


def fits(unit: str, wanted: str) -> bool:
    """Whether one unit can be converted to the other; counts, or a plain number, to an angle not without knowing how many make a turn."""
    if is_angle(wanted) and (unit == "1" or is_count(unit)):
        return False
    try:
        conversion(unit, wanted, "")
    except UserError:
        return unit == wanted
    return True


def words(name: str) -> list[str]:
    """The words of a name, in lower case, digits apart: "MotorSpeed_1" has motor, speed, 1."""
    return [word.lower() for word in _WORDS.findall(name.split(".")[-1] if "." in name else name)]


def _numbers(of: Sequence[str]) -> list[str]:
    return [word for word in of if word.isdigit()]


def _overlap(mine: Sequence[str], theirs: Sequence[str]) -> float:
    """The share of words that the two have in common, words of one meaning and beginnings of words among them."""
    if not mine or not theirs:
        return 0.0
    hits = sum(max((_alike(a, b) for b in theirs), default=0.0) for a in mine)
    return hits / max(len(mine), len([word for word in theirs if word not in _ALIKE[-1]]))


def _alike(a: str, b: str) -> float:
    if a == b:
        return 1.0
    if any(a in group and b in group for group in _ALIKE):
        return 0.95 if min(len(a), len(b)) > 1 else 0.9
    if len(a) >= 3 and len(b) >= 3 and (a.startswith(b) or b.startswith(a)):
        return 0.9
    return 0.0
