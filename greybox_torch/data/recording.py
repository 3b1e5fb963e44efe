"""A recording: the samples of one experiment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from greybox_torch.errors import UserError

Role = Literal["estimation", "validation"]


@dataclass(frozen=True)
class Channel:
    """A measured signal: an input or an output of the model, by the model's name for it. `unit` may be empty."""

    name: str
    unit: str


@dataclass(frozen=True, eq=False)
class Recording:
    """One experiment, N samples of every channel.

    `time` is in seconds, shape (N,), strictly increasing, starting anywhere. `signals` holds an array of shape (N,)
    for each channel's name, in the channel's unit; missing samples are NaN. `sample_time` is the median step of the
    experiment's `time`, in seconds. `rows` is the half-open slice of the file `source` that the recording stands for.
    """

    name: str
    role: Role
    time: NDArray[np.float64]
    sample_time: float
    signals: dict[str, NDArray[np.float64]]
    source: Path
    rows: tuple[int, int]

    def __len__(self) -> int:
        return len(self.time)

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
        )
