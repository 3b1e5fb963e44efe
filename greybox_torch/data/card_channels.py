"""What a card says of its files: channels, experiments, time stamps."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator, model_validator

from greybox_torch.data.expression import Expression, parse_expression
from greybox_torch.errors import did_you_mean

_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]")


def printable(text: str) -> str:
    """Raises ValueError where a name has line breaks or other control characters, which no table or message could show."""
    if _CONTROL.search(text):
        raise ValueError(f"found {text!a}, expected text without control characters")
    return text


def visible(text: str) -> str:
    """Raises ValueError where a name has nothing but spaces, which no heading or legend could show."""
    if not text.strip():
        raise ValueError(f"found {text!a}, expected a name that can be seen")
    return text


Text = Annotated[str, Field(min_length=1), AfterValidator(printable)]
Name = Annotated[Text, AfterValidator(visible)]
Finite = Annotated[float, Field(allow_inf_nan=False)]

TimeUnit = Literal["s", "ms", "us", "µs", "ns", "min", "h"]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


class Entry(BaseModel):
    """A table of the card: typed strictly, and closed, so that a misspelt key cannot pass unseen."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def _column(value: Any) -> Any:
    """A column by its position, from 1 on, is called "#2" in readers."""
    if isinstance(value, int) and not isinstance(value, bool):
        if value < 1:
            raise ValueError(f"{value} is not a column; expected a name, or a position from 1 on")
        return f"#{value}"
    return value


def _an_expression(text: str | None) -> str | None:
    if text is not None:
        parse_expression(text)
    return text


class ChannelEntry(Entry):
    """Where a channel stands in the files: file value × scale = value in `unit`, or converted from `file_unit`.

    `expr` computes it from several columns. It has neither where every experiment gives its `constants`, or a column of its own.
    `derivative` is the cut-off in Hz where the channel is the rate of change of what the file holds. `missing` has the error values of
    the file, one or several, numbers or texts: its samples that are such a one are missing.
    """

    column: Text | None = None
    expr: Text | None = None
    unit: str = ""
    scale: Finite = 1.0
    file_unit: Text | None = None
    derivative: Finite | None = None
    missing: Finite | Text | list[Finite | Text] | None = None

    _position = field_validator("column", mode="before")(_column)
    _parsed = field_validator("expr")(_an_expression)

    @field_validator("scale")
    @classmethod
    def _not_zero(cls, scale: float) -> float:
        if scale == 0.0:
            raise ValueError("a scale of zero would erase the channel; expected a number other than zero")
        return scale

    @field_validator("missing")
    @classmethod
    def _numbers_without_quotes(cls, missing: float | str | list[float | str] | None) -> Any:
        for value in missing if isinstance(missing, list) else [missing]:
            if isinstance(value, str) and _is_number(value):
                raise ValueError(f'found "{value}", expected a number without quotes, or text that is no number')
        return missing

    @field_validator("derivative")
    @classmethod
    def _a_frequency(cls, cutoff: float | None) -> float | None:
        if cutoff is not None and cutoff <= 0.0:
            raise ValueError(f"{cutoff:g} is not a cut-off; expected a frequency above zero, in Hz")
        return cutoff

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.column is not None and self.expr is not None:
            raise ValueError('both "column" and "expr" are given; expected one of them')
        if self.file_unit is not None and "scale" in self.model_fields_set:
            raise ValueError(
                'both "scale" and "file_unit" are given; expected one of them; scale alone can convert and reverse the sign, '
                "for example scale = -0.001 from mm to m"
            )
        if self.file_unit is not None and not self.unit:
            raise ValueError('"file_unit" is given without "unit"; expected both, to convert from one to the other')
        return self

    @property
    def error_values(self) -> tuple[float, ...]:
        """Numbers of the file that stand for missing samples."""
        return tuple(value for value in self._missing if not isinstance(value, str))

    @property
    def missing_marks(self) -> tuple[str, ...]:
        """Texts of the file that stand for missing samples."""
        return tuple(value.strip() for value in self._missing if isinstance(value, str))

    @property
    def _missing(self) -> list[float | str]:
        return self.missing if isinstance(self.missing, list) else [] if self.missing is None else [self.missing]

    def expression(self) -> Expression:
        """How the channel comes from columns."""
        return parse_expression(self.expr) if self.expr is not None else Expression.of_column(str(self.column))


class TimeEntry(Entry):
    """The column of time stamps, and its unit. `date` is the column of their dates, where it has times of day alone."""

    column: Text
    unit: TimeUnit = "s"
    date: Text | None = None

    _position = field_validator("column", "date", mode="before")(_column)

    @property
    def seconds(self) -> float:
        """One unit, in seconds."""
        return {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}[self.unit]


class OwnColumn(Entry):
    """A column of one experiment alone, or `expr`, from which a channel is computed there. Where its file is in other units than those
    of the card's other files, `unit` is that of time stamps, `file_unit` or `scale` how a channel is converted; without them it is as the
    card says.
    """

    column: Text | None = None
    expr: Text | None = None
    unit: Text | None = None
    date: Text | None = None
    file_unit: Text | None = None
    scale: Finite | None = None

    _position = field_validator("column", "date", mode="before")(_column)
    _parsed = field_validator("expr")(_an_expression)

    @model_validator(mode="after")
    def _one_conversion(self) -> Self:
        if (self.column is None) == (self.expr is None):
            found = 'neither "column" nor "expr" is' if self.column is None else 'both "column" and "expr" are'
            raise ValueError(f"{found} given; expected one of them")
        if self.file_unit is not None and self.scale is not None:
            raise ValueError('both "scale" and "file_unit" are given; expected one of them')
        if self.scale == 0.0:
            raise ValueError("a scale of zero would erase the channel; expected a number other than zero")
        return self


class FileClock(Entry):
    """The time stamps of one of several files that are joined in time: what is left out is as the card, or the experiment, says of `time`.

    `offset` are seconds to add, where the clock of this file begins at another zero, or is wrong. A `column` of its own has the `date` that
    is given with it. Where `unit` is given, it holds, however little the files then have in common.
    """

    column: Text | None = None
    unit: TimeUnit | None = None
    date: Text | None = None
    offset: Finite = 0.0

    _position = field_validator("column", "date", mode="before")(_column)


class ExperimentEntry(Entry):
    """One recording: its file or files, its role, and optionally `rows` ([start, stop], counted from zero, stop left
    out) and columns of its own.

    Of `columns`, each is a name or position, or a table with the units of this file: `{ column = "t", unit = "ms" }` for `time`,
    `{ column = "h", file_unit = "cm" }` for a channel.
    `join` says how several files belong together: "concatenate", one after the other, "time", columns matched by their time stamps, or
    "rows", samples of one number side by side; a column by its position is then counted over the columns of all files.
    `clocks`, by file, has the time stamps of files that are joined in time and whose stamps have a name, a unit or a zero of their own:
    `{ "camera.csv" = { column = "stamp", unit = "ms", offset = 0.35 } }`.
    `constants` are channels that have one value throughout the experiment, in the channel's `unit`: they need no column, and where they
    have one it is not read.
    """

    name: Name
    file: Annotated[list[Text], Field(min_length=1, max_length=1000)]
    join: Literal["concatenate", "time", "rows"] | None = None
    role: Literal["estimation", "validation"] = "estimation"
    rows: Annotated[list[int], Field(min_length=2, max_length=2)] | None = None
    columns: dict[str, OwnColumn] = {}
    clocks: dict[str, FileClock] = {}
    constants: dict[str, Finite] = {}

    @field_validator("file", mode="before")
    @classmethod
    def _one_or_more(cls, file: Any) -> Any:
        return [file] if isinstance(file, str) else file

    @field_validator("columns", mode="before")
    @classmethod
    def _names_or_tables(cls, columns: Any) -> Any:
        if not isinstance(columns, dict):
            return columns
        return {name: own if isinstance(own, dict | OwnColumn) else {"column": own} for name, own in columns.items()}

    @model_validator(mode="after")
    def _joined(self) -> Self:
        if len(self.file) > 1 and self.join is None:
            raise ValueError(
                'several files are given without "join"; expected join = "concatenate" (one after the other), '
                '"time" (columns matched by their time stamps) or "rows" (samples of one number side by side)'
            )
        if self.clocks and (len(self.file) < 2 or self.join != "time"):
            raise ValueError(
                '"clocks" is given for other files than several with join = "time"; expected columns = { time = … } for a single file'
            )
        for file in self.clocks:
            if file not in self.file:
                raise ValueError(
                    f'clocks: no file "{file}"{did_you_mean(file, self.file)}; expected {", ".join(self.file)}'
                )
        return self
