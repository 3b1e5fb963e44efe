"""Counts of an encoder or a converter: numbers of which no file says how many make a turn."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.expression import Expression
from greybox_torch.errors import UserError
from greybox_torch.files import toml_text

_COUNTS = re.compile(r"(counts?|cnts?|ticks?|pulses?|incr?|increments?|steps?|lsb|digits?|raw)( */ *s)?", re.IGNORECASE)
_ANGLE = re.compile(r"(?P<angle>rad|mrad|deg|degrees?|°|rev|revolutions?|turns?)( */ *s| s\^?-1)?|rpm")
_ENCODER = re.compile(r"(^|[\W_\d])(enc([\W_\d]|$)|encoder|geber|drehgeber)", re.IGNORECASE)
_NAMED = re.compile(r"(^|[\W_])(counts?|cnts?|ticks?)\W*$", re.IGNORECASE)
_OF_SAMPLES = re.compile(
    r"(frames?|samples?|index|idx|counter|count|cnt|seq|sequence|rows?|lines?|nr|no|num|number|records?|scans?|packets?|bild|i|k|n)"
    r"([_ .]?(no|nr|num|number|id|idx|index|count|counter|cnt))?[.:#]?",
    re.IGNORECASE,
)
_TURN = {"rad": "2*pi", "mrad": "2000*pi", "rev": "1", "revolution": "1", "turn": "1", "rpm": "60"}
"""A turn, in the units that are not degrees."""


def is_count(unit: str) -> bool:
    """Whether a unit that a file says is a number of counts, or of counts per second."""
    return _COUNTS.fullmatch(unit.strip("[]() ")) is not None


def named_as_count(column: str) -> bool:
    """Whether the name of a column tells an encoder or counts: enc, encoder_2, motor_counts."""
    return _ENCODER.search(column) is not None or ends_in_counts(column)


def ends_in_counts(column: str) -> bool:
    """Whether the name of a column ends with counts as its unit: motor_counts, enc [counts]."""
    return _NAMED.search(column) is not None


def named_as_counter(column: str) -> bool:
    """Whether a column is called as one that counts samples: frame, sample_no, idx."""
    return _OF_SAMPLES.fullmatch(column.strip()) is not None


def counts_samples(column: str, values: NDArray[np.float64]) -> bool:
    """Whether a column is called so, and its values (N,) are whole numbers."""
    return named_as_counter(column) and bool(np.all(np.abs(values - np.round(values)) < 1e-6))


def is_angle(unit: str) -> bool:
    """Whether a channel's unit is one that counts of an encoder become: an angle, or its rate."""
    return _ANGLE.fullmatch(unit.strip()) is not None


def may_count(unit: str, wanted: str) -> bool:
    """Whether counts of a unit may be an angle, or its rate where they are per second: an encoder's own counts are no rate."""
    found = _ANGLE.fullmatch(wanted.strip())
    if found is None:
        return False
    rate = found[0] != found["angle"]
    return not rate or unit.strip("[]() ").replace(" ", "").endswith("/s")


def in_turns(column: str, unit: str) -> str:
    """The expression that makes a column of counts an angle in `unit`, or its rate, of an encoder with 65536 counts a turn."""
    return _of(column if column.isidentifier() else f'col("{column}")', unit)


def _of(counts: str, unit: str) -> str:
    found = _ANGLE.fullmatch(unit.strip())
    angle = (found["angle"] or "rpm").removesuffix("s") if found else ""
    return f"{_TURN.get(angle, '360')}*{counts}/65536"


def check_counts(place: str, formula: Expression, path: Path, told: str, unit: str) -> None:
    """Raises UserError, beginning with `place`, where values of a channel are counts and nothing says how many make its unit.

    Args:
        told: the unit of the values, as the file or the card says it.
        unit: the channel's.
    """
    if not is_count(told) or not unit or is_count(unit) or unit in ("1", "-"):
        return
    if is_angle(unit):
        expr = in_turns(formula.text, unit) if isinstance(formula.tree, str) else _of(f"({formula.text})", unit)
        advice = f"how many counts has a turn? For 65536 expected expr = {toml_text(expr)} in place of the column, or the scale"
    else:
        advice = f"expected scale = …, how many {unit} a count is"
    raise UserError(f'{place}: {path} has "{formula.text}" in "{told}", the card says "{unit}"; {advice}')
