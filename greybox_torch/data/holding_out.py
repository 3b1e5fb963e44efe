"""What a data set holds out for validation where nothing says so, and what its recordings have to be."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from greybox_torch.data.asked_for import left_out
from greybox_torch.data.recording import Recording
from greybox_torch.data.source import JOINED_IN_TIME
from greybox_torch.errors import UserError
from greybox_torch.name_lists import listed

HELD_OUT = " (held out)"
"""What the name of an experiment's last quarter ends in."""


def by_experiment(recordings: Sequence[Recording], *, held_out_by_default: bool) -> dict[str, tuple[str, ...]]:
    """The names of the recordings of each experiment of a card: of two, where its last quarter is held out by default."""
    names: dict[str, tuple[str, ...]] = {}
    for recording in recordings:
        experiment = recording.name.removesuffix(HELD_OUT) if held_out_by_default else recording.name
        names[experiment] = (*names.get(experiment, ()), recording.name)
    return names


def hold_out_last_quarters(recordings: Sequence[Recording], path: Path | None) -> tuple[Recording, ...]:
    """Every recording as two: its first three quarters, and the last as "<name> (held out)" with the role "validation".

    Raises UserError where a held-out part would have the name of another recording. `path` is the card, for the message.
    """
    parts = []
    for recording in recordings:
        split = len(recording) - len(recording) // 4
        if split == len(recording):
            raise UserError(
                f"{_of(recording, path)}: has {len(recording)} samples, of which no quarter can be held out; expected more"
            )
        parts += [
            recording.part(0, split),
            recording.part(split, len(recording), name=f"{recording.name}{HELD_OUT}", role="validation"),
        ]
    where = "DataSet, recordings" if path is None else f"{path}, [[experiment]] name"
    check_same_names([part.name for part in parts], f"{where}, with the last quarter of each held out")
    return tuple(parts)


def check_same_names(names: Sequence[str], where: str) -> None:
    """Raises UserError where two recordings have one name: results are by name."""
    name, count = Counter(names).most_common(1)[0]
    if count > 1:
        raise UserError(f'{where}: {count} experiments are named "{name}"; expected different names')


def check_no_channel_is_empty(recordings: Sequence[Recording], path: Path | None) -> None:
    """Raises UserError where a recording has no sample at all of one of its channels."""
    for recording in recordings:
        for channel, values in recording.signals.items():
            if np.isnan(values).all():
                others = [r for r in recordings if not np.isnan(r.signals[channel]).all()]
                advice = f"; {left_out(channel)}" if others and path is not None else ""
                if any(JOINED_IN_TIME in note for note in recording.notes):
                    names = listed([file.name for file in recording.further])
                    advice += (
                        f"; where the stamps of {names} are in another unit, or begin at another zero, `clocks` says so"
                    )
                if recording.name.removesuffix(HELD_OUT) in {r.name for r in others} - {recording.name}:
                    advice = (
                        '; it is the last quarter, which is held out where no experiment has the role "validation": give one that role, '
                        "or take the rows in which the channel is measured"
                    )
                # rows of the first file, which need not be the one that has the column
                of = "" if recording.source is None else f" of {recording.source}"
                of += f" with {listed([file.name for file in recording.further])}" if recording.further else ""
                raise UserError(
                    f'{_of(recording, path)}, channel "{channel}": all {len(values)} samples are '
                    f"missing (NaN), rows {list(recording.rows)}{of}; expected numbers{advice}"
                )


def _of(recording: Recording, path: Path | None) -> str:
    return f'recording "{recording.name}"' if path is None else f'{path}, [[experiment]] "{recording.name}"'
