"""A data set: recordings of one machine, and what the card beside them says."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, get_args

from greybox_torch.data.card import InitialEntry, ParameterEntry
from greybox_torch.data.card_controller import LoopEntry
from greybox_torch.data.card_errors import entries
from greybox_torch.data.given_loops import loops_of
from greybox_torch.data.holding_out import check_no_channel_is_empty, check_same_names, hold_out_last_quarters
from greybox_torch.data.recording import Channel, Recording
from greybox_torch.errors import UserError

Hold = Literal["zoh", "foh"]

# What a place on the card is called where there is no card: the argument of `DataSet` or of `Recording`.
_ARGUMENTS = {
    "[channels]": "channels",
    "[model] name": "argument model",
    "[model.parameters]": "argument parameters:",
    "[model.initial]": "argument initial:",
    "[[experiment]]": "recordings:",
    "[[experiment]] role:": "role of the recordings:",
}


@dataclass(frozen=True, eq=False, init=False, repr=False)
class DataSet:
    """The recordings of one machine, read and checked.

    `channels` and `recordings` keep their order. `hold` says how inputs run between samples: "zoh" constant,
    "foh" straight lines. `path` is the card, None where the data set was made in memory. `model`, `parameters` and `initial` are the
    card's [model] section as it stands, not yet compared with any model; the file part of a model named like "my_motor.py:Motor" is
    absolute. `held_out_by_default` is True where no recording had the role "validation" and the last quarter of each became one.
    `sha256` identifies the samples.
    """

    recordings: tuple[Recording, ...]
    hold: Hold
    name: str
    path: Path | None
    channels: dict[str, Channel]
    model: str | None
    parameters: dict[str, ParameterEntry]
    initial: dict[str, InitialEntry]
    held_out_by_default: bool
    diagnosis: dict[str, Any]
    limits: dict[str, Any]
    controller: dict[str, LoopEntry]
    beliefs: dict[str, Any]

    def __init__(
        self,
        recordings: Iterable[Recording],
        *,
        hold: Hold = "zoh",
        name: str = "recordings",
        path: Path | None = None,
        channels: Mapping[str, Channel] | None = None,
        model: str | None = None,
        parameters: Mapping[str, ParameterEntry | Mapping[str, Any] | float] | None = None,
        initial: Mapping[str, InitialEntry | Mapping[str, Any] | float] | None = None,
        held_out_by_default: bool | None = None,
        diagnosis: Mapping[str, Any] | None = None,
        limits: Mapping[str, Any] | None = None,
        controller: Mapping[str, LoopEntry | Mapping[str, Any]] | None = None,
        beliefs: Mapping[str, Any] | None = None,
    ) -> None:
        """A data set of recordings that are in memory.

        Args:
            recordings: at least one, with names that differ and the same channels.
            hold: how inputs run between samples, "zoh" (constant) or "foh" (straight lines).
            name: what results call the data set.
            path: the card that all this was read from.
            channels: by default those of the recordings, in the units that the recordings give.
            model: a built-in system, or "my_motor.py:Motor".
            parameters: what is known of the model's parameters: a start value, or {"value": …, "lower": …, "upper": …, "fixed": …}.
            initial: what is known of start states: a value, or {"value": …, "fixed": …}.
            held_out_by_default: by default decided here: where no recording has the role "validation", the last quarter of each becomes
                one, called "<name> (held out)". Where it is given, recordings stay as they are.
            diagnosis: settings of a diagnosis by name, as the card's table [diagnosis] has them; what is given to `diagnose` goes before.
            limits: of a next recording, as the card's table [limits] has them: seconds, and by input, output or state
                {"lower": …, "upper": …, "rate": …}.
            controller: the loops that a next recording runs under, as the card's table [controller] has them.
            beliefs: what is known beforehand of what a diagnosis looks for, as the card's table [beliefs] has it: by "port/mechanism"
                "likely", "unlikely" or a probability.

        Raises:
            UserError: no recordings, two of one name, channels or units that differ between them, a channel without any sample in one
                of them, or entries that cannot be right.

        Examples:
            >>> sweep = Recording.from_arrays("sweep", {"voltage": [1.0] * 40, "speed": [0.0] * 40}, sample_time=0.01)
            >>> DataSet([sweep], name="Motor on the bench").recordings[1]
            Recording('sweep (held out)', validation: 10 samples of voltage, speed, 0.01 s apart)
        """
        held = _checked_recordings(recordings)
        if hold not in get_args(Hold):
            raise UserError(f'DataSet, hold: found {hold!r}, expected "zoh" or "foh"')
        if not isinstance(name, str) or not name:
            raise UserError(f"DataSet, name: found {name!r}, expected text that is not empty")
        channels = _channels_of(held) if channels is None else dict(channels)
        hold_out = held_out_by_default is None and all(recording.role != "validation" for recording in held)
        held = hold_out_last_quarters(held, path) if hold_out else held
        check_no_channel_is_empty(held, path)
        own: dict[str, Any] = {
            "recordings": held,
            "hold": hold,
            "name": name,
            "path": path,
            "channels": channels,
            "model": model,
            "parameters": entries("parameters", parameters, ParameterEntry),
            "initial": entries("initial", initial, InitialEntry),
            "held_out_by_default": hold_out or bool(held_out_by_default),
            "diagnosis": dict(diagnosis or {}),
            "limits": dict(limits or {}),
            "controller": loops_of(controller, channels, hold, "DataSet"),
            "beliefs": dict(beliefs or {}),
        }
        for field, value in own.items():
            object.__setattr__(self, field, value)

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of the samples, as a hexadecimal string."""
        return hash_of(self.recordings)

    def __repr__(self) -> str:
        listed = "".join(f"\n  {recording!r}" for recording in self.recordings)
        return f"DataSet({self.name!r}, hold={self.hold!r}, {len(self.recordings)} recordings:{listed})"

    def estimation(self) -> tuple[Recording, ...]:
        """The recordings that parameters are estimated from, in the card's order."""
        return tuple(recording for recording in self.recordings if recording.role == "estimation")

    def validation(self) -> tuple[Recording, ...]:
        """The recordings that results are judged on, in the card's order."""
        return tuple(recording for recording in self.recordings if recording.role == "validation")

    def place(self, section: str = "") -> str:
        """How a message about the card's `section`, like "[channels]", begins: with the card, or where there is none with the argument."""
        if self.path is not None:
            return f"{self.path}: {section}" if section else str(self.path)
        argument = _ARGUMENTS.get(section, section)
        return f'data set "{self.name}": {argument}' if section else f'data set "{self.name}"'


def _checked_recordings(recordings: Iterable[Recording]) -> tuple[Recording, ...]:
    # of a table of arrays, in a dictionary or a data frame, the names alone would be read
    table = isinstance(recordings, Mapping | str) or hasattr(recordings, "columns")
    one = table or isinstance(recordings, Recording) or not isinstance(recordings, Iterable)
    held: tuple[Any, ...] = (recordings,) if one else tuple(recordings)
    for recording in held:
        if not isinstance(recording, Recording):
            raise UserError(
                f"DataSet, recordings: found an object of type {type(recording).__name__}, expected recordings "
                "(Recording.from_arrays and Recording.from_dataframe make them)"
            )
    if not held:
        raise UserError("DataSet, recordings: found none, expected at least one")
    check_same_names([recording.name for recording in held], "DataSet, recordings")
    first = held[0]
    for other in held[1:]:
        if set(other.signals) != set(first.signals):
            differ = ", ".join(sorted(set(other.signals) ^ set(first.signals)))
            raise UserError(
                f'DataSet, recordings: "{other.name}" has the channels {", ".join(other.signals)}; '
                f'expected those of "{first.name}": {", ".join(first.signals)} (they differ in {differ}; '
                "a channel that has one value throughout may be a single number)"
            )
    return held


def _channels_of(recordings: tuple[Recording, ...]) -> dict[str, Channel]:
    """The recordings' channels, each in the one unit that they give."""
    channels = {}
    for name in recordings[0].signals:
        given = {unit: recording.name for recording in recordings if (unit := recording.units.get(name))}
        if len(given) > 1:
            found = " and ".join(f'"{unit}" in "{recording}"' for unit, recording in given.items())
            raise UserError(f'DataSet, recordings: channel "{name}" has the units {found}; expected one unit')
        channels[name] = Channel(name, next(iter(given), ""))
    return channels


def hash_of(recordings: Iterable[Recording]) -> str:
    """SHA-256 over the times and signals of the recordings, as a hexadecimal string."""
    digest = hashlib.sha256()
    for recording in recordings:
        for label, values in [("time", recording.time), *sorted(recording.signals.items())]:
            digest.update(f"{label} {len(values)}\n".encode())
            digest.update(values.astype("<f8").tobytes())
    return digest.hexdigest()
