"""The channels of a card: for each its column, and what is known of its unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from greybox_torch.data.card_constants import as_constant
from greybox_torch.data.column_units import unit_in, without_ending, without_unit
from greybox_torch.data.counts import ends_in_counts, in_turns, is_angle, is_count, may_count, named_as_count
from greybox_torch.data.understood_units import understood
from greybox_torch.data.units import slip
from greybox_torch.data.unwrapping import turn_within, unwrapped
from greybox_torch.drafting.clock import SECONDS, Clock
from greybox_torch.drafting.likened import likened, of_the_same_last_name
from greybox_torch.drafting.magnitudes import slips
from greybox_torch.drafting.matching import Wanted, also_fitting, letter_unit, matched, words
from greybox_torch.drafting.recorded import Recorded
from greybox_torch.model import Body, GreyBoxModel

_SAME_TURN = 1e-6
"""Of a turn: by how much two columns of one angle may differ, but for a constant."""


@dataclass(frozen=True)
class Draft:
    """A line of [channels]: ``column`` is None where none was found, ``file_unit`` empty where it is the channel's. ``expr`` is what may be
    meant of counts, to be completed.
    """

    name: str
    unit: str
    column: str | None
    file_unit: str = ""
    remark: str = ""
    expr: str = ""


@dataclass(frozen=True)
class Drafted:
    """The channels of one file, and the columns that are none."""

    channels: tuple[Draft, ...]
    others: tuple[str, ...] = field(default_factory=tuple)

    @property
    def columns(self) -> dict[str, str]:
        """By channel, of those that one was found for."""
        return {draft.name: draft.column for draft in self.channels if draft.column is not None}


def wanted_of(model: GreyBoxModel) -> list[Wanted]:
    """The inputs and outputs of a model."""
    return [
        *(Wanted(i.name, i.unit, True) for i in model.inputs),
        *(Wanted(o.name, o.unit, False, _ports_of(o.name, model)) for o in model.outputs),
    ]


def _ports_of(output: str, model: GreyBoxModel) -> tuple[str, ...]:
    """The ports of which the state that is called as an output is a signal."""
    return tuple(port.name for port in model.ports if output in port.signals.values())


def drafted(file: Recorded, clock: Clock, model: GreyBoxModel | None, first: Drafted | None = None) -> Drafted:
    """Columns matched with the model's inputs and outputs; without a model, every column a channel of its own name.

    Args:
        first: the channels of the first file, where this is a further one: its columns may have those names with something added.
    """
    columns = [name for name in file.columns if name != clock.column]
    said = {name: unit for name in columns if (unit := file.units.get(name, "") or unit_in(name))}
    units = {name: understood(unit) or unit for name, unit in said.items()}
    alike = likened(first.columns, columns) if first is not None else {}
    if model is None and alike:
        own = tuple(Draft(channel, units.get(name, ""), name) for channel, name in alike.items())
        return Drafted(own, tuple(name for name in columns if name not in alike.values()))
    if model is None:
        return Drafted(tuple(Draft(_channel_name(name), units.get(name, ""), name) for name in columns))
    wanted = wanted_of(model)
    bare = _bare(columns)
    by_name = matched(wanted, list(bare), _by(bare, units))
    alike_named = also_fitting(wanted, list(bare), _by(bare, units), by_name)
    found = {channel: bare[name] for channel, name in by_name.items()}
    found |= alike if first is None else alike | of_the_same_last_name(first.columns, found | alike, columns)
    found |= {channel: other for channel, column in found.items() if (other := _counting_on(file, column, columns))}
    suspected = _suspected(file, clock, model, wanted, found)
    counts_left = _counts_left(wanted, found, units, columns)
    doubts = {
        channel: f'please check: guessed from the name, which "{bare[other]}" fits as well'
        for channel, other in alike_named.items()
        if found.get(channel) == bare[by_name[channel]]
    }
    channels = tuple(_draft(channel, found, units, suspected, columns, doubts, counts_left) for channel in wanted)
    return Drafted(channels, tuple(name for name in columns if name not in found.values()))


def _counting_on(file: Recorded, column: str, columns: Sequence[str]) -> str | None:
    """Where a column begins anew after a turn, another one of the file that has the turns added up, from wherever it counts."""
    values = file.columns[column]
    turn, jumps = turn_within(values, "") if np.isfinite(values).all() else (0.0, ())
    if not len(jumps):
        return None
    added = unwrapped(values, turn)
    apart = {name: np.ptp(file.columns[name] - added) for name in columns if len(file.columns[name]) == len(added)}
    return next((name for name, difference in apart.items() if difference < _SAME_TURN * turn), None)


def _bare(columns: Sequence[str]) -> dict[str, str]:
    """Columns by their names without units, as far as two do not become one by that."""
    short = [without_ending(name) for name in columns]
    return {one if short.count(one) == 1 else name: name for one, name in zip(short, columns, strict=True)}


def _by(bare: dict[str, str], units: dict[str, str]) -> dict[str, str]:
    return {short: units[name] for short, name in bare.items() if name in units}


def _draft(
    channel: Wanted,
    found: dict[str, str],
    units: dict[str, str],
    suspected: dict[str, str],
    columns: Sequence[str],
    doubts: Mapping[str, str],
    counts_left: Mapping[str, str],
) -> Draft:
    """``doubts``: what to say by channel where another column's name fits as well; ``counts_left``: a column of counts by the angle that it
    may be.
    """
    column = found.get(channel.name)
    if is_angle(channel.unit) and (counts := _counts(column, units) or counts_left.get(channel.name, "")):
        told = "how many counts has a turn? Write them for 65536"
        doubt = "" if column else "; please check the column: guessed from its name"
        return Draft(channel.name, channel.unit, None, remark=f"{told}{doubt}", expr=in_turns(counts, channel.unit))
    if column is None:
        free = [name for name in columns if name not in found.values()]
        left = f"; left over: {', '.join(name + _unknown(units.get(name, '')) for name in free)}" if free else ""
        constant = f"; or, of a constant, no column and {as_constant(channel.name)} in every [[experiment]]"
        told = f"no column fits{left}{constant if channel.is_input else ''}"
        return Draft(channel.name, channel.unit, None, remark=told)
    unit = units.get(column, "") or _gravity(column, channel.unit)
    certain = any(words(name) == words(channel.name) for name in (column, without_ending(column)))
    doubt = (
        ""
        if certain or column.lower() == channel.name.lower()
        else doubts.get(channel.name, "please check: guessed from the name")
    )
    if unit and channel.unit and slip(unit, channel.unit) is not None:
        told = "converted from the unit that the file says" if column in units else f"in {unit}, as its name ends"
        return Draft(channel.name, channel.unit, column, unit, f"{told}; {doubt}" if doubt else told)
    if channel.name in suspected and not unit:
        guess = suspected[channel.name]
        return Draft(channel.name, channel.unit, column, remark=f'its size suggests {guess}: add file_unit = "{guess}"')
    if channel.unit and (unknown := _unknown(units.get(column, "")).strip(" ()")):
        told = f"the file's values are {unknown}, which is not converted; please check"
        return Draft(channel.name, channel.unit, column, remark=f"{told}; {doubt}" if doubt else told)
    return Draft(channel.name, channel.unit, column, remark=doubt)


def _unknown(unit: str) -> str:
    """Behind a column whose unit is none that is known, so that no unit could tell what the column is."""
    return f' (of the unknown unit "{unit}")' if unit and not (understood(unit) or is_count(unit)) else ""


def _counts(column: str | None, units: Mapping[str, str]) -> str:
    """The column that was found for an angle, where it holds an encoder's counts; else ""."""
    held = column is not None and is_count(units.get(column, "counts" if ends_in_counts(column) else ""))
    return column if held and column is not None else ""


def _counts_left(
    wanted: Sequence[Wanted], found: Mapping[str, str], units: Mapping[str, str], columns: Sequence[str]
) -> dict[str, str]:
    """The only column of counts that is left, by the first angle without a column; of a rate, only counts per second."""
    units_of = {name: units.get(name, "counts" if named_as_count(name) else "") for name in columns}
    counting = [name for name in columns if name not in found.values() and is_count(units_of[name])]
    if len(counting) != 1:
        return {}
    (column,) = counting
    open_ones = (one.name for one in wanted if one.name not in found and may_count(units_of[column], one.unit))
    first = next(open_ones, None)
    return {} if first is None else {first: column}


def _gravity(column: str, wanted: str) -> str:
    """The unit of accelerations in multiples of gravity by their name; other letters are too often no units to convert by them."""
    unit = letter_unit(column, wanted)
    return unit if unit == "g0" else ""


def _suspected(
    file: Recorded, clock: Clock, model: GreyBoxModel, wanted: Sequence[Wanted], found: dict[str, str]
) -> dict[str, str]:
    outputs = {channel.name: channel for channel in wanted}
    bodies = [(str(port.position), str(port.speed)) for port in model.ports if isinstance(port, Body)]
    pairs = [(outputs[a], outputs[b]) for a, b in bodies if a in outputs and b in outputs]
    if clock.broken:
        return {}
    if clock.column is not None:
        time = file.columns[clock.column] * SECONDS.get(clock.unit, 1.0)
    elif clock.sample_time is not None:
        time = np.arange(file.samples, dtype=np.float64) * clock.sample_time
    else:
        return {}
    return slips(pairs, file.columns, found, time)


def _channel_name(column: str) -> str:
    """A name that a model could use."""
    name = "_".join(words(without_unit(column))) or "channel"
    name = name if not name[0].isdigit() else f"channel_{name}"
    return "clock" if name == "time" else name
