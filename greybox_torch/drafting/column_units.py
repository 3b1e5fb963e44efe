"""Units that stand in the name of a column: "speed [rpm]", "angle (deg)", "torque_Nm"."""

from __future__ import annotations

import re

from greybox_torch.data.units import dimensionality

_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]{1,20})\s*[\])]\s*$")
_ENDINGS = {
    "rpm": "rpm", "deg": "deg", "degs": "deg/s", "dps": "deg/s", "rad": "rad", "rads": "rad/s", "radps": "rad/s", "nm": "N m",
    "mnm": "mN m", "mm": "mm", "ma": "mA", "mv": "mV", "bar": "bar", "degc": "degC", "kw": "kW",
}  # fmt: skip


def unit_in(column: str) -> str:
    """The unit; empty where none can be read."""
    bracketed = _BRACKETS.search(column)
    if bracketed and _is_unit(bracketed[1]) and not bracketed[1].isdigit():
        return bracketed[1]
    _, underscore, last = column.rpartition("_")
    return _ENDINGS.get(last.lower(), "") if underscore else ""


def without_unit(column: str) -> str:
    """The name without the brackets at its end."""
    bracketed = _BRACKETS.search(column)
    return column[: bracketed.start()].strip() if bracketed and unit_in(column) else column


def _is_unit(text: str) -> bool:
    try:
        dimensionality(text)
    except ValueError:
        return False
    return True
