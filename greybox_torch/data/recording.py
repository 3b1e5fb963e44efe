"""A recording: the samples of one experiment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from greybox_torch.data.in_memory import Samples, samples_of_arrays, samples_of_frame
from greybox_torch.data.role import Role, check_role
from greybox_torch.errors import UserError


@dataclass(frozen=True)
class Channel:
    """A measured signal: an input or an output of the model, by the model's name for it. `unit` may be empty.

    `column` is the one of the card that it comes from, `file_unit` the unit of its values there, as the card or the name of the column
    says; both are empty where that is not known. `factor` is by what its values there are multiplied for those in `unit`; not a number
    where more is done to them.
    """

    name: str
    unit: str
    column: str = field(default="", compare=False)
    file_unit: str = field(default="", compare=False)
    factor: float = field(default=1.0, compare=False)


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """One experiment, N samples of every channel; made by `from_arrays`, by `from_dataframe`, or by `load_dataset` from a file.

    `time` is in seconds, shape (N,), strictly increasing, starting anywhere. `signals` holds an array of shape (N,)
    for each channel's name, in the channel's unit; missing samples are NaN. `sample_time` is the median step of the
    experiment's `time`, in seconds, or the mean one where rounding alone tells steps apart, as that of dates in seconds since 1970.
    `rows` is the half-open slice of the file `source` that the recording stands for; `source` is None where there is no file, and
    `further` are those that were joined to it. `units` are by channel, where they are known. `notes` say what was done to
    the file's samples, or what is remarkable about their time stamps. `between`, by channel, marks the samples (N,) that lie on straight
    lines between those of a slower file or column: an output was not measured there. `constants` are the channels of which it is known
    that they have one value throughout, as the card or a single number in memory says.

    All arrays are read-only, and no change to what they were made from reaches them.
    """

    name: str
    role: Role
    time: NDArray[np.float64]
    sample_time: float
    signals: dict[str, NDArray[np.float64]]
    source: Path | None = None
    rows: tuple[int, int] = (0, 0)
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    further: tuple[Path, ...] = ()
    between: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        own = {"time": _read_only(self.time), "signals": {n: _read_only(v) for n, v in self.signals.items()}}
        own |= {"units": dict(self.units), "rows": self.rows if self.rows != (0, 0) else (0, len(self.time))}
        for name, value in own.items():
            object.__setattr__(self, name, value)

    def measured(self, channel: str) -> NDArray[np.float64]:
        """Samples (N,) of an output, NaN where none was measured."""
        values, between = self.signals[channel], self.between.get(channel)
        return values if between is None or len(between) != len(values) else np.where(between, np.nan, values)

    @classmethod
    def from_arrays(
        cls,
        name: str,
        signals: Mapping[str, ArrayLike],
        *,
        sample_time: float | None = None,
        time: ArrayLike | None = None,
        role: Role = "estimation",
        units: Mapping[str, str] | None = None,
    ) -> Recording:
        """A recording from arrays in memory, which are copied.

        Args:
            name: what results call the experiment.
            signals: N samples of every input and output, by the model's name for it, in the channel's unit; NaN, None or masked where a
                sample is missing. A single number is a constant, the value throughout.
            sample_time: seconds between samples; the first is at 0 s. Or
            time: the N time stamps in seconds, increasing; or of NumPy's kinds datetime64 and timedelta64.
            role: "estimation" (parameters are estimated from it) or "validation" (results are judged on it).
            units: by channel; a channel that is not mentioned has the unit that another recording of the data set gives it, or none.

        Raises:
            UserError: not one of ``sample_time`` and ``time``, arrays of different length, fewer than ten samples, a channel with no
                sample at all, time stamps that do not increase, infinite values, or values that are no real numbers.

        Examples:
            >>> import numpy as np
            >>> Recording.from_arrays("sweep", {"voltage": np.ones(50), "speed": np.zeros(50)}, sample_time=1e-3, units={"voltage": "V"})
            Recording('sweep', estimation: 50 samples of voltage [V], speed, 0.001 s apart)
        """
        made = samples_of_arrays(name, signals, sample_time=sample_time, time=time, units=units)
        check_role(role, f'recording "{name}", role')
        return cls._of(name, role, made)

    @classmethod
    def _of(cls, name: str, role: Role, made: Samples) -> Recording:
        held = made.time, made.sample_time, made.signals
        return cls(name, role, *held, units=made.units, notes=made.notes, constants=made.constants)

    @classmethod
    def from_dataframe(
        cls,
        name: str,
        frame: Any,
        *,
        time: str | None = None,
        sample_time: float | None = None,
        role: Role = "estimation",
        units: Mapping[str, str] | None = None,
        columns: Mapping[str, str] | None = None,
        constants: Mapping[str, float] | None = None,
    ) -> Recording:
        """A recording from a table in memory: a DataFrame of pandas or polars, a Table of pyarrow, a dictionary of arrays.

        Args:
            name: what results call the experiment.
            frame: any object that names its columns and gives each by ``frame[column]``, N samples long.
            time: the column of time stamps in seconds, or of dates and times, as text too. Or
            sample_time: seconds between samples.
            role: "estimation" or "validation".
            units: by channel.
            columns: the column of every channel, by the model's name for the channel; by default every column but ``time`` is a channel
                of the same name.
            constants: channels without a column, which have one value throughout.

        Raises:
            UserError: ``frame`` has no such column, and as :meth:`from_arrays` does.

        Examples:
            >>> frame = {"t": [0.01 * k for k in range(20)], "u": [1.0] * 20, "y": [0.0] * 20}
            >>> Recording.from_dataframe("steps", frame, time="t", columns={"voltage": "u", "speed": "y"})
            Recording('steps', estimation: 20 samples of voltage, speed, 0.01 s apart)
        """
        made = samples_of_frame(
            name, frame, time=time, sample_time=sample_time, units=units, columns=columns, constants=constants
        )
        check_role(role, f'recording "{name}", role')
        return cls._of(name, role, made)

    def __len__(self) -> int:
        return len(self.time)

    @property
    def seconds(self) -> float:
        """How long it lasts, s: the step after its last sample included."""
        return float(self.time[-1] - self.time[0]) + self.sample_time

    def __repr__(self) -> str:
        units = {name: self.units.get(name) for name in self.signals}
        channels = ", ".join(f"{name} [{unit}]" if unit else name for name, unit in units.items())
        return (
            f"Recording({self.name!r}, {self.role}: {len(self)} samples of {channels}, {self.sample_time:.6g} s apart)"
        )

    def part(self, start: int, stop: int, *, name: str | None = None, role: Role | None = None) -> Recording:
        """The samples start, …, stop − 1 as a recording of their own (views, not copies).

        Raises UserError where the slice is empty or reaches outside the recording.
        """
        if not 0 <= start < stop <= len(self):
            raise UserError(
                f"recording {self.name!r}: part({start}, {stop}) is not a slice of its {len(self)} samples; "
                f"expected 0 <= start < stop <= {len(self)}"
            )
        return replace(
            self,
            name=self.name if name is None else name,
            role=self.role if role is None else role,
            time=self.time[start:stop],
            signals={channel: values[start:stop] for channel, values in self.signals.items()},
            rows=(self.rows[0] + start, self.rows[0] + stop),
            between={channel: marked[start:stop] for channel, marked in self.between.items()},
        )


def _read_only(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The array itself where nobody can write to it, else a copy."""
    held: Any = values
    while isinstance(held, np.ndarray) and not held.flags.writeable:
        held = held.base
    if held is None and values.dtype == np.float64:
        return values
    copy = np.array(values, dtype=np.float64)
    copy.setflags(write=False)
    return copy
