"""A data set: recordings of one machine, and what the card beside them says."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from greybox_torch.data.card import InitialEntry, ParameterEntry
from greybox_torch.data.recording import Channel, Recording


@dataclass(frozen=True, eq=False)
class DataSet:
    """The recordings of one machine, read and checked.

    `channels` and `recordings` keep the card's order. `hold` says how inputs run between samples: "zoh" constant,
    "foh" straight lines. `model`, `parameters` and `initial` are the card's [model] section as it stands, not yet
    compared with any model; the file part of a model named like "my_motor.py:Motor" is absolute.
    `held_out_by_default` is True where the card gave no role "validation" and the last quarter of every experiment
    became one. `sha256` identifies the samples.
    """

    name: str
    path: Path
    hold: Literal["zoh", "foh"]
    channels: dict[str, Channel]
    recordings: tuple[Recording, ...]
    model: str | None
    parameters: dict[str, ParameterEntry]
    initial: dict[str, InitialEntry]
    held_out_by_default: bool
    sha256: str

    def estimation(self) -> tuple[Recording, ...]:
        """The recordings that parameters are estimated from, in the card's order."""
        return tuple(recording for recording in self.recordings if recording.role == "estimation")

    def validation(self) -> tuple[Recording, ...]:
        """The recordings that results are judged on, in the card's order."""
        return tuple(recording for recording in self.recordings if recording.role == "validation")


def hash_of(recordings: Iterable[Recording]) -> str:
    """SHA-256 over the times and signals of the recordings, as a hexadecimal string."""
    digest = hashlib.sha256()
    for recording in recordings:
        for label, values in [("time", recording.time), *sorted(recording.signals.items())]:
            digest.update(f"{label} {len(values)}\n".encode())
            digest.update(values.astype("<f8").tobytes())
    return digest.hexdigest()
