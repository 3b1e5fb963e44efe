"""The card `dataset.toml`: what it may say, and messages for what it may not.

`docs/howto/data.md` has examples.
"""

from __future__ import annotations

import shlex
from collections import Counter
from contextlib import suppress
from datetime import date
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PlainValidator, ValidationError, field_validator, model_validator

from greybox_torch.data.card_channels import (
    ChannelEntry,
    Entry,
    ExperimentEntry,
    Finite,
    Name,
    Text,
    TimeEntry,
    printable,
)
from greybox_torch.data.card_constants import check_constants
from greybox_torch.data.card_controller import LoopEntry, check_loops
from greybox_torch.data.card_errors import describe
from greybox_torch.data.expression import Expression
from greybox_torch.data.own_columns import own_channels, own_time, wrong_in
from greybox_torch.data.readers import READERS
from greybox_torch.errors import UserError, did_you_mean, quoted
from greybox_torch.name_lists import brief
from greybox_torch.reading import read_toml

USUAL = "dataset.toml"
"""The name of a card that is the only one in its folder."""

TIME = "time"
"""A name that no channel has: in an experiment's `columns` it is that of the time stamps."""


class ParameterEntry(Entry):
    """What is known about a parameter of the model, in the parameter's unit. What is left out is as the model declares it."""

    value: Finite | None = None
    lower: float | None = None
    upper: float | None = None
    fixed: bool | None = None

    @field_validator("lower", "upper")
    @classmethod
    def _a_number(cls, bound: float | None) -> float | None:
        if bound != bound:
            raise ValueError("nan is not a bound; expected a number, -inf or inf")
        return bound

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.lower is not None and self.upper is not None and self.lower >= self.upper:
            raise ValueError(f"lower = {self.lower:g} is not below upper = {self.upper:g}")
        if self.value is not None and self.upper is not None and self.value > self.upper:
            raise ValueError(f"value = {self.value:g} is above upper = {self.upper:g}")
        if self.value is not None and self.lower is not None and self.value < self.lower:
            raise ValueError(f"value = {self.value:g} is below lower = {self.lower:g}")
        return self


class InitialEntry(Entry):
    """What is known about a start state, in the state's unit. What is left out is as the model declares it."""

    value: Finite | None = None
    fixed: bool | None = None


class ModelEntry(Entry):
    """The [model] section."""

    name: Text | None = None
    parameters: dict[str, ParameterEntry] = {}
    initial: dict[str, InitialEntry] = {}


def _a_date(recorded: Any) -> date:
    """A date of TOML, with a time of day or without."""
    if not isinstance(recorded, date):
        raise ValueError(f"found {quoted(recorded)}, expected a date without quotes, such as 2026-03-01")
    return recorded


class Card(Entry):
    """The whole of `dataset.toml`. Either `sample_time` (s) is given or `time`, a column of time stamps.

    `hold` is the input between samples: held ("zoh") or linear ("foh"). `resample` makes the time stamps even, that
    many seconds apart; `decimate` keeps one sample of that many, after a low pass.
    `diagnosis` has settings of `greybox diagnose`, `beliefs` what is known beforehand about missing effects, `limits`
    what `greybox design` may ask of the machine; those commands check them. `controller` has the loops that a designed
    recording runs under.
    For `greybox fleet`, `machine` says which machine was recorded (several cards may be of one) and `recorded` when.
    """

    name: Name | None = None
    sample_time: Finite | None = None
    time: TimeEntry | None = None
    resample: Finite | None = None
    decimate: Annotated[int, Field(ge=2, le=10_000)] | None = None
    hold: Literal["zoh", "foh"] = "zoh"
    channels: Annotated[dict[str, ChannelEntry], Field(min_length=1)]
    experiment: Annotated[list[ExperimentEntry], Field(min_length=1)]
    model: ModelEntry = ModelEntry()
    diagnosis: dict[str, Any] = {}
    limits: dict[str, Any] = {}
    controller: dict[str, LoopEntry] = {}
    beliefs: dict[str, Any] = {}
    machine: Name | None = None
    recorded: Annotated[date | None, PlainValidator(_a_date)] = None

    @field_validator("time", mode="before")
    @classmethod
    def _of_seconds(cls, time: Any) -> Any:
        return {"column": time} if isinstance(time, str | int) and not isinstance(time, bool) else time

    @field_validator("sample_time", "resample")
    @classmethod
    def _positive(cls, sample_time: float | None) -> float | None:
        if sample_time is not None and sample_time <= 0.0:
            raise ValueError(f"{sample_time:g} is not a sample time; expected a number above zero, in seconds")
        return sample_time

    @field_validator("channels")
    @classmethod
    def _time_is_not_a_channel(cls, channels: dict[str, ChannelEntry]) -> dict[str, ChannelEntry]:
        for name in channels:
            printable(name)
        if TIME in channels:
            raise ValueError(
                f'"{TIME}" cannot name a channel; time stamps are named at the top of the card: time = "…"'
            )
        return channels

    @model_validator(mode="after")
    def _one_clock(self) -> Self:
        if self.sample_time is None and self.time is None:
            raise ValueError(
                '"sample_time" is missing; expected sample_time = <seconds>, or time = "<column of time stamps>"'
            )
        if self.sample_time is not None and self.time is not None:
            raise ValueError('both "sample_time" and "time" are given; expected one of them')
        if self.sample_time is not None and self.resample is not None:
            raise ValueError(
                '"resample" is of time stamps; expected time = "<column of time stamps>" in the place of sample_time'
            )
        return self

    @model_validator(mode="after")
    def _names_of_experiments_differ(self) -> Self:
        name, count = Counter(experiment.name for experiment in self.experiment).most_common(1)[0]
        if count > 1:
            raise ValueError(f'{count} experiments are named "{name}"; expected different names')
        return self

    @model_validator(mode="after")
    def _columns_are_of_channels(self) -> Self:
        for experiment in self.experiment:
            place = f'[[experiment]] "{experiment.name}", columns'
            for key in experiment.columns:
                if key == TIME and self.time is None:
                    raise ValueError(f'{place}: "{TIME}" needs time = "<column of time stamps>" at the top of the card')
                if key != TIME and key not in self.channels:
                    known = [*self.channels, TIME]
                    raise ValueError(
                        f'{place}: no channel is named "{key}"{did_you_mean(key, known)}; expected {", ".join(known)}'
                    )
                if wrong := wrong_in(key, experiment.columns[key], self.channels.get(key)):
                    raise ValueError(f"{place}, {key}: {wrong}")
        return self

    @model_validator(mode="after")
    def _channels_have_a_source(self) -> Self:
        check_constants(self.channels, self.experiment)
        return self

    @model_validator(mode="after")
    def _loops_are_of_channels(self) -> Self:
        check_loops(self.controller, self.channels, self.hold)
        return self

    def of(self, experiment: ExperimentEntry) -> Self:
        """The card as it is for one experiment, with the columns and units that are its own."""
        time = None if self.time is None else own_time(self.time, experiment.columns.get(TIME))
        return self.model_copy(update={"time": time, "channels": own_channels(self.channels, experiment.columns)})

    def formulas(self, experiment: ExperimentEntry) -> dict[str, Expression]:
        """By channel, how it comes from columns in an experiment: without those that are constants there."""
        own = self.of(experiment).channels
        return {name: entry.expression() for name, entry in own.items() if name not in experiment.constants}


def _what_else(path: Path) -> str:
    """What stands there where it is often named in the place of a card: its folder, a recording, a name that is not quite right."""
    if path.is_dir() and (path / USUAL).is_file():
        return f"is a folder; expected the card in it, {path / USUAL}"
    if path.is_dir():
        others = brief(sorted(str(other) for other in path.glob("*.toml")))
        return f"is a folder without {USUAL}; expected a data card" + (f", such as {others}" if others else "")
    if path.suffix.lower() in READERS and path.is_file():
        return f"is a recording; expected a data card, {USUAL} (`greybox card {shlex.quote(str(path))}` writes one)"
    if path.suffix.lower() == ".py" and path.is_file():
        return f'is a model; expected a data card, {USUAL}, which names it: [model] name = "{path.name}:<its class>"'
    if not (path.exists() or path.is_symlink()) and path.parent.is_dir():
        hint = did_you_mean(str(path), map(str, path.parent.glob("*.toml")))
        return f"no such file{hint}; expected a data card, {USUAL}" if hint else ""
    return ""


def card_at(path: Path | None) -> Card | None:
    """The card that data were read from; None where they are from memory, or it is gone. Raises UserError as :func:`read_card` does."""
    return None if path is None or not path.is_file() else read_card(path)


def read_card(path: Path) -> Card:
    """The card at `path`. Raises UserError, with one message, for a file or a field that is wrong."""
    with suppress(OSError, ValueError):  # of names that no file can have, which reading says
        if found := _what_else(path):
            raise UserError(f"{path}: {found}")
    return card_of(read_toml(path, "a data card, dataset.toml"), path)


def card_of(content: dict[str, Any], path: Path) -> Card:
    """The card that the tables ``content`` make at `path`, be it written there or not. Raises UserError as :func:`read_card` does."""
    try:
        return Card.model_validate(content)
    except ValidationError as error:
        raise UserError(describe(path, error, content, Card)) from None
