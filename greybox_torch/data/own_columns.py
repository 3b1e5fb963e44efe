"""Columns that one experiment has for a channel or for its time stamps, in units of their own where its file is of another logger."""

from __future__ import annotations

from collections.abc import Mapping
from typing import get_args

from greybox_torch.data.card_channels import ChannelEntry, OwnColumn, TimeEntry
from greybox_torch.files import toml_key, toml_text

_UNITS: tuple[str, ...] = get_args(TimeEntry.model_fields["unit"].annotation)


def in_that_experiment(name: str, entry: str) -> str:
    """What to write for a channel, or the time stamps, of one experiment alone; ``entry`` are keys with their values."""
    return f"columns = {{ {toml_key(name)} = {{ {entry} }} }} in that [[experiment]]"


def conversion_written(name: str, column: str, keys: str, *, own: bool) -> str:
    """How to write ``keys`` that convert a channel: in its line as they are, or where the column is one experiment's ``own``, there."""
    if not own:
        return keys
    return in_that_experiment(name, keys if keys.startswith("expr") else f"column = {toml_text(column)}, {keys}")


def own_time(time: TimeEntry, own: OwnColumn | None) -> TimeEntry:
    """The time stamps of an experiment that may name a column of its own, in the card's unit unless it gives another. Whether the card's
    column of dates belongs to it, :func:`greybox_torch.data.file_clocks.with_clocks` sees in the file.
    """
    if own is None:
        return time
    given = own.model_dump(include={"column", "unit", "date"}, exclude_none=True)
    return TimeEntry.model_validate(time.model_dump(exclude_none=True) | given)


def own_channels(channels: Mapping[str, ChannelEntry], own: Mapping[str, OwnColumn]) -> dict[str, ChannelEntry]:
    """The channels of an experiment: each as on the card, but for its own columns and how these are converted."""
    return {name: _with(entry, own[name]) if name in own else entry for name, entry in channels.items()}


def _with(entry: ChannelEntry, own: OwnColumn) -> ChannelEntry:
    kept = {name: getattr(entry, name) for name in entry.model_fields_set - {"expr", "column"}}
    converted = {name: value for name in ("scale", "file_unit") if (value := getattr(own, name)) is not None}
    if converted:
        kept = {name: value for name, value in kept.items() if name not in ("scale", "file_unit")}
    source = {"column": own.column} if own.expr is None else {"expr": own.expr}
    return ChannelEntry.model_validate(kept | converted | source)


def wrong_in(name: str, own: OwnColumn, entry: ChannelEntry | None) -> str:
    """What is wrong with an experiment's own column of a channel, or of the time stamps (without an ``entry``); "" where nothing is."""
    if entry is None:
        given = [key for key in ("expr", "file_unit", "scale") if getattr(own, key) is not None]
        expected = '{ column = "t", unit = "ms" } of time stamps'
        if own.unit is not None and own.unit not in _UNITS:
            return f'found unit = "{own.unit}", expected {" ".join(_UNITS)}'
    else:
        given = [key for key in ("unit", "date") if getattr(own, key) is not None]
        expected = f'{{ column = "…", file_unit = "…" }} or {{ column = "…", scale = … }}; the unit of "{name}" is that in [channels]'
    if given:
        return f'found "{given[0]}", expected {expected}'
    if entry is not None and own.file_unit is not None and not entry.unit:
        return f'"file_unit" is given, and "{name}" has no unit in [channels]; expected both, to convert from one to the other'
    return ""
