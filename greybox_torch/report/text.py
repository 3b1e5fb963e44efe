"""Numbers, units and names as a reader expects them in print."""

from __future__ import annotations

import math
import re

from markupsafe import Markup, escape

from greybox_torch.diagnosis.one_of import in_words
from greybox_torch.report.code_words import marked

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_GREEK = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "zeta": "ζ",
    "theta": "θ",
    "mu": "μ",
    "sigma": "σ",
    "omega": "ω",
}

MOST_DIGITS = 8
"""Of a value whose standard deviation is next to nothing: seen were more than a hundred, off the page."""

LOST = 10.0
"""Times its size that a value's deviation is, from which its place leaves nothing of it."""


def number(value: float, digits: int = 3) -> str:
    """So many significant digits, a true minus sign, a power of ten only where plain digits would be hard to read."""
    if not math.isfinite(value):
        return "—"
    if value == 0:
        return "0"
    power = math.floor(math.log10(abs(value)))
    if -4 <= power < 6:
        rounded = round(value, digits - 1 - power)
        return f"{rounded:.{max(0, digits - 1 - power)}f}".replace("-", "−")
    return f"{value / 10.0**power:.{digits - 1}f}·10{str(power).translate(_SUPERSCRIPT)}".replace("-", "−")


def measured(value: float, deviation: float | None) -> str:
    """A value with its standard deviation: two digits of that, and the value to the same place; to three digits where none were left."""
    if deviation is None or not math.isfinite(deviation) or deviation <= 0 or not math.isfinite(value):
        return number(value, 4)
    if deviation >= LOST * abs(value) > 0:
        return f"{number(value)} ± {number(deviation, 2)}"
    place = 1 - math.floor(math.log10(deviation))
    largest = math.floor(math.log10(max(abs(value), deviation)))
    if -4 <= largest < 6 and place <= 7:
        digits = max(0, place)
        return f"{round(value, place):.{digits}f} ± {round(deviation, place):.{digits}f}".replace("-", "−")
    scale, digits = 10.0**largest, max(0, place + largest)
    if digits > MOST_DIGITS:
        return f"{number(value, MOST_DIGITS)} ± {number(deviation, 2)}"
    ten = f"10{str(largest).translate(_SUPERSCRIPT)}"
    return f"({value / scale:.{digits}f} ± {deviation / scale:.{digits}f})·{ten}".replace("-", "−")


def percent(share: float) -> str:
    """A share as a percentage: tenths below one percent and above ninety-nine, whole percents between."""
    if not math.isfinite(share):
        return "—"
    hundred = 100.0 * share
    if 0 < abs(hundred) < 0.1:
        return "under 0.1 %" if hundred > 0 else "−0.1 %"
    near_end = abs(hundred) < 1 or 99 < hundred < 100
    text = f"{hundred:.1f}" if near_end and hundred != 0 else f"{hundred:.0f}"
    return f"{text} %".replace("-", "−")


def fit(value: float, digits: int = 1) -> str:
    """A fit in percent; where the simulation overflows or is worlds away, words."""
    if not math.isfinite(value):
        return "overflow"
    return f"{value:.{digits}f} %".replace("-", "−") if value > -1e4 else "far off"


def with_minus(sentence: str) -> str:
    """A sentence whose negative numbers have a minus, as all other numbers of a report, in the place of a hyphen."""
    return re.sub(r"(?<![\w.)-])-(?=\d)", "−", sentence)


def unit(text: str) -> str:
    """A unit as it is printed: `N m/(rad/s)^2` becomes N·m/(rad/s)², and "1", that of plain numbers, nothing."""
    if text == "1":
        return ""
    raised = re.sub(r"\^(-?\d+)(?!\d*\.\d)", lambda found: found.group(1).translate(_SUPERSCRIPT), text)
    return re.sub(r"\s+", "·", raised.strip())


def with_unit(text: str, of: str) -> str:
    """A number with its unit; a unit that is empty adds nothing."""
    return f"{text} {unit(of)}".rstrip()


def axis(name: str, of: str) -> str:
    """A label for an axis: the quantity and its unit."""
    return f"{words(name)} [{unit(of)}]" if unit(of) else words(name)


def words(name: str) -> str:
    """An identifier as words, `motor_speed` as motor speed; what begins or ends with a single letter, T_j or UA_l, is a symbol with an
    index and stays as it is written.
    """
    first, *_, last = name.split("_") if "_" in name else ("", "")
    symbol = any(len(end) == 1 and end.isalpha() for end in (first, last))
    return name if symbol else name.replace("_", " ")


def title(name: str) -> str:
    """:func:`words` with a capital, which would make another symbol of a symbol."""
    told = words(name)
    symbol = "_" in told or len(told) == 1 or told != told.lower()
    return told if symbol else first_capital(told)


def mechanism(name: str) -> str:
    """A mechanism's name as words, with the names of persons in capitals."""
    return "unknown effect" if name == "unknown" else in_words(name)


def first_capital(sentence: str) -> str:
    """The text with its first letter in capitals, the rest as it is."""
    return sentence[:1].upper() + sentence[1:]


def symbol(name: str) -> Markup:
    """A parameter's name as a formula would have it: F_c with a subscript, alpha as α; longer names as the law and the card have them."""
    letter, underscore, index = name.partition("_")
    letter = _GREEK.get(letter, letter)
    if len(letter) == 1:
        below = Markup("<sub>{}</sub>").format(index) if underscore else Markup("")
        return Markup("<i>{}</i>{}").format(letter, below)
    return escape(name)


def prose(sentence: str) -> Markup:
    """A sentence for a page, what stands between backticks as code."""
    return Markup(marked(str(escape(sentence))))


def seconds(value: float) -> str:
    """A duration: tenths below ten seconds, minutes above two."""
    if value < 10:
        return f"{value:.1f} s"
    return f"{value:.0f} s" if value < 120 else f"{int(value) // 60} min {int(value) % 60} s"
