"""The card `dataset.toml`: what it may say, and messages for what it may not.

The format is fixed by the project's contract; see the README for an example.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from greybox_torch.data.card_errors import describe
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.reading import read_toml

TIME = "time"  # in an experiment's `columns`, the key that renames the column of time stamps

Text = Annotated[str, Field(min_length=1)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


class Entry(BaseModel):
    """A table of the card: typed strictly, and closed, so that a misspelt key cannot pass unseen."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ChannelEntry(Entry):
    """Where a channel stands in the files: file value × scale = value in `unit`."""

    column: Text
    unit: str = ""
    scale: Finite = 1.0

    @field_validator("scale")
    @classmethod
    def _not_zero(cls, scale: float) -> float:
        if scale == 0.0:
            raise ValueError("a scale of zero would erase the channel; expected a number other than zero")
        return scale


class ExperimentEntry(Entry):
    """One recording: its file, its role, and optionally a slice of rows and columns of its own."""

    name: Text
    file: Text
    role: Literal["estimation", "validation"] = "estimation"
    rows: Annotated[list[int], Field(min_length=2, max_length=2)] | None = None
    columns: dict[str, Text] = {}


class ParameterEntry(Entry):
    """What is known about a parameter of the model; None where the card is silent. Values in the parameter's unit."""

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
        lower = -float("inf") if self.lower is None else self.lower
        upper = float("inf") if self.upper is None else self.upper
        if lower >= upper:
            raise ValueError(f"lower = {lower:g} is not below upper = {upper:g}")
        if self.value is not None and not lower <= self.value <= upper:
            raise ValueError(f"value = {self.value:g} lies outside its bounds [{lower:g}, {upper:g}]")
        return self


class InitialEntry(Entry):
    """What is known about a start state; None where the card is silent. Value in the state's unit."""

    value: Finite | None = None
    fixed: bool | None = None


class ModelEntry(Entry):
    """The [model] section."""

    name: Text | None = None
    parameters: dict[str, ParameterEntry] = {}
    initial: dict[str, InitialEntry] = {}


class Card(Entry):
    """The whole of `dataset.toml`. Either `sample_time` (s) is given or `time`, a column of time stamps (s)."""

    name: Text | None = None
    sample_time: Finite | None = None
    time: Text | None = None
    hold: Literal["zoh", "foh"] = "zoh"
    channels: Annotated[dict[str, ChannelEntry], Field(min_length=1)]
    experiment: Annotated[list[ExperimentEntry], Field(min_length=1)]
    model: ModelEntry = ModelEntry()

    @field_validator("sample_time")
    @classmethod
    def _positive(cls, sample_time: float | None) -> float | None:
        if sample_time is not None and sample_time <= 0.0:
            raise ValueError(f"{sample_time:g} is not a sample time; expected a number above zero, in seconds")
        return sample_time

    @field_validator("channels")
    @classmethod
    def _time_is_not_a_channel(cls, channels: dict[str, ChannelEntry]) -> dict[str, ChannelEntry]:
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
        return self

    @model_validator(mode="after")
    def _names_of_experiments_differ(self) -> Self:
        names = [experiment.name for experiment in self.experiment]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f'{names.count(name)} experiments are named "{name}"; expected different names')
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
        return self


def read_card(path: Path) -> Card:
    """The card at `path`. Raises UserError, with one message, for a file or a field that is wrong."""
    content = read_toml(path, "a data card, dataset.toml")
    try:
        return Card.model_validate(content)
    except ValidationError as error:
        raise UserError(describe(path, error, content, Card)) from None
