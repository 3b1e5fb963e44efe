"""Units on a card that the names of its columns contradict: `time_s` in ms, `n_motor_rpm` in rad/s without a conversion."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import permutations
from pathlib import Path

from greybox_torch.data.card import TIME, Card, read_card
from greybox_torch.data.card_channels import ChannelEntry, FileClock
from greybox_torch.data.clocks_written import in_clocks
from greybox_torch.data.column_units import OF_QUANTITY, is_set_apart, parts_of, unit_in
from greybox_torch.data.counts import ends_in_counts, in_turns, is_angle
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.own_columns import conversion_written, in_that_experiment
from greybox_torch.data.time_units import SPELLINGS
from greybox_torch.data.units import conversion, dimensionality, per_minute, turns_per_time
from greybox_torch.errors import UserError
from greybox_torch.files import toml_text

_KNOWN = re.compile(
    "s|ms|us|µs|ns|h|m|mm|cm|km|um|µm|ft|kg|N|kN|mN|MN|kgf|lbf|Nm|kNm|mNm|MNm|Ncm|Nmm|rad|mrad|deg|cdeg|degrees|degC|degF|K|V|mV|kV|A|mA|W|kW|MW|mW|"
    "J|kJ|Pa|hPa|kPa|MPa|bar|mbar|psi|Hz|kHz|rpm|rev|kts|knots?|Ohm|l|L|ml|lpm|US|gal|gpm"
)
"""What is a unit in a name, and nothing else: [t], (k), (in), (est) are units as well, and hardly ever meant as such."""
_DEGREES = re.compile(r"(?:°|deg)?\s*([CF])")
"""Degrees of a temperature in brackets; a letter alone is another unit, and means them where the card says a temperature."""

_SURE = frozenset(("rpm", "deg/s", "rad/s", "mN m", "mm", "degC", "degF"))
"""Endings that are units whatever the card says. Of others, such as x_bar and heat_rad, only another scale is told."""
_AS_WRITTEN = {"Nm": "N m", "mA": "mA", "mV": "mV", "kW": "kW"}
"""Sure only if written so: speed_ma is a moving average, u_mv a manipulated variable."""
_BESIDE = (
    ("m/s", ("kn", "kt", "kts", "knots")),
    ("m/s^2", ("g", "mg")),
    ("N m", ("Nmm", "Ncm")),
    ("m", ("ft",)),
    ("rad", ("cdeg",)),
)
"""Words that are units beside such a quantity, in brackets or as the last of a name: those of boats and aircraft, whose logs have speeds
in knots and accelerations in multiples of gravity. Elsewhere "kn" may be kN and "g" a gram."""
_ACCELERATION = re.compile(r"(a|acc\w*|beschl\w*|a_?[xyz])([\W_\d]|$)", re.IGNORECASE)
"""What a name begins with of which a "g" at the end is gravity and no other word."""
_TEMPERATURE = {"[temperature]": 1.0}


@dataclass(frozen=True)
class Contradiction(InASentence):
    """``place`` is `time`, or `channel "speed"`, and its experiment where that alone has the column; ``write`` what to write instead."""

    place: str
    column: str
    told: str
    said: str
    write: str

    @property
    def found(self) -> str:
        said = "a plain number" if self.said == "1" else self.said
        return f'{self.place}: column "{self.column}" is in {self.told} by its name, but the card says {said}'


def contradictions(card: Path | None) -> list[Contradiction]:
    """Those of the card at a path; none where data are from memory."""
    if card is None or not card.is_file():
        return []
    return list(dict.fromkeys(_found(read_card(card))))


def _found(card: Card) -> Iterator[Contradiction]:
    whole = {TIME: card.time.column if card.time else None} | {n: e.column for n, e in card.channels.items()}
    named: list[tuple[str, dict[str, str | None], Card, dict[str, FileClock]]] = [("", whole, card, {})]
    for e in card.experiment:
        own: dict[str, str | None] = {name: column.column for name, column in e.columns.items()}
        named.append((f'[[experiment]] "{e.name}", ', own, card.of(e), e.clocks))
    columns = {column for _, of, *_ in named for column in of.values() if column}
    for where, of, card, clocks in named:
        for name, column in of.items():
            if column is None:
                continue
            if name == TIME and card.time is not None:
                told = time_in(column)
                if told and _differ(told, card.time.unit):
                    entry = f'column = {toml_text(column)}, unit = "{told}"'
                    time = in_that_experiment(TIME, entry) if where else f"time = {{ {entry} }}"
                    write = f"{time}, which converts the stamps to s, if the equations are in s"
                    yield Contradiction(f"{where}{TIME}", column, told, card.time.unit, write)
            elif name in card.channels:
                to_write = partial(conversion_written, name, column, own=bool(where))
                yield from _of_channel(f'{where}channel "{name}"', column, card.channels[name], columns, to_write)
        yield from _of_clocks(where, clocks, card)
        yield from _exchanged(where, {n: c for n, c in of.items() if c and n in card.channels}, card.channels, columns)


def _of_clocks(where: str, clocks: Mapping[str, FileClock], card: Card) -> Iterator[Contradiction]:
    """Of the time stamps of files that are joined in time, where the card gives their column and no unit."""
    for file, clock in clocks.items():
        told = "" if clock.column is None or clock.unit else time_in(clock.column)
        if clock.column is not None and card.time is not None and told and _differ(told, card.time.unit):
            write = in_clocks(file, column=clock.column, unit=told, offset=clock.offset or None, date=clock.date)
            yield Contradiction(f'{where}clocks, "{file}"', clock.column, told, card.time.unit, write)


def _exchanged(
    where: str, named: Mapping[str, str], entries: Mapping[str, ChannelEntry], columns: set[str]
) -> Iterator[Contradiction]:
    """Pairs of channels of which each column is by its name of the other one's quantity: no scale makes up for that."""
    told = {name: _unit_of(column, columns, entries[name].unit)[0] for name, column in named.items()}
    for one, other in permutations(named, 2):
        scaled = [name for name in (one, other) if "scale" in entries[name].model_fields_set]
        if one not in scaled or not (told[one] and told[other] and named[one] != named[other]):
            continue
        theirs, own = (_dimension(entries[name].unit) for name in (other, one))
        if None not in (theirs, own) and own != theirs == _dimension(told[one]) and own == _dimension(told[other]):
            write = (
                f'column = {toml_text(named[other])}, which "{other}" has: by their names the two columns are exchanged'
            )
            yield Contradiction(f'{where}channel "{one}"', named[one], told[one], entries[one].unit, write)


def _of_channel(
    place: str, column: str, entry: ChannelEntry, columns: set[str], to_write: Callable[[str], str]
) -> Iterator[Contradiction]:
    if "scale" in entry.model_fields_set:  # whoever gives a factor has thought of the unit
        return
    said = entry.file_unit or entry.unit
    if ends_in_counts(column) and is_angle(said):
        turns = to_write(f"expr = {toml_text(in_turns(column, said))}")
        write = f"{turns} for 65536 counts a turn; or, if the name is wrong, {to_write('scale = 1.0')}"
        yield Contradiction(place, column, "counts", said, write)
    rate = "" if entry.derivative is None or entry.file_unit else "/s"
    told, sure = _unit_of(column, columns, said)
    if not (told and said and _differ(told + rate, said)):
        return
    if sure or _dimension(told + rate) == _dimension(said):
        converted = to_write(f'file_unit = "{told}"')
        write = converted if _converts(told + rate, entry.unit) else f"another column, or a unit like {told}"
        yield Contradiction(place, column, told, said, f"{write}; or, if the name is wrong, {to_write('scale = 1.0')}")


def _unit_of(column: str, columns: set[str], said: str) -> tuple[str, bool]:
    """The unit that a name tells beside what the card says, and whether it can mean nothing else.

    The unit registry, which takes its time to load, is asked only where a letter may mean a temperature.
    """
    told = unit_in(column)
    beside = _told_beside(column, told, said)
    if beside:
        return beside, True
    if is_set_apart(column):
        degrees = _DEGREES.fullmatch(told)
        if degrees and (len(told) > 1 or _dimension(said) == _TEMPERATURE):
            told = f"deg{degrees[1]}"
        words = re.findall(r"[^\W\d_]+", told.replace("min", ""))
        known = turns_per_time(told) or all(_KNOWN.fullmatch(word) for word in words)
        alone = told in ("min", "K")  # the least, a gain
        if told in ("deg", "°", "degrees"):  # of a temperature, where the card may say one
            alone = "[temperature]" in (_dimension(said) or {})
        return (told, not alone) if known else ("", False)
    stem, separator, last = parts_of(column)
    if last in OF_QUANTITY and OF_QUANTITY[last].match(stem):
        phases = {other for other in columns if re.fullmatch(re.escape(stem + separator) + "[A-Za-z]", other)}
        return (last, True) if len(phases) == 1 else ("", False)
    return told, told in _SURE or last in _AS_WRITTEN


def _told_beside(column: str, told: str, said: str) -> str:
    """The unit that the last word of a name is beside what the card says, of those of one quantity; "" where there is none."""
    set_apart = is_set_apart(column)
    stem, _, last = parts_of(column)
    word = told if set_apart else last
    for unit, words in _BESIDE:
        if word in words and _dimension(said) == _dimension(unit) and (unit != "rad" or is_angle(said)):
            alone = word == "g" and not set_apart
            return word if not alone or _ACCELERATION.match(stem) else ""
    return ""


def time_in(column: str) -> str:
    """The unit that the name of a column of time stamps tells."""
    bracketed = re.search(r"[\[(]\s*([^\W\d_]+)\s*[\])]\s*$", column)
    if bracketed:
        return SPELLINGS.get(bracketed[1].lower(), "")
    last = re.split(r"[\W_]", column.strip())[-1].lower()
    return SPELLINGS.get(last, "") if last != column.lower() or len(last) > 3 else ""


def _differ(told: str, said: str) -> bool:
    """Whether two units differ in scale or dimension; False where the card's is unknown."""
    if told == said or _dimension(said) is None or all(unit == "rpm" or per_minute(unit) for unit in (told, said)):
        return False
    try:
        factor, offset = conversion(told, said, "")
    except UserError:
        return True
    return abs(factor - 1.0) > 1e-9 or offset != 0.0


def _converts(told: str, unit: str) -> bool:
    try:
        conversion(told, unit, "")
    except UserError:
        return False
    return True


def _dimension(unit: str) -> dict[str, float] | None:
    try:
        return dimensionality(unit)
    except ValueError:
        return None
