"""Snapshots while a training runs."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from greybox_torch.training.curriculum import Curriculum
from greybox_torch.training.physics import Physics
from greybox_torch.training.snapshot import Snapshot, save_snapshot
from greybox_torch.training.state import TrainingState

SNAPSHOT_SECONDS = 0.5
"""Time between two snapshots at the least."""


class Keeper:
    """Writes snapshots, but not more often than every :data:`SNAPSHOT_SECONDS`."""

    def __init__(self, path: Path | None, about: Mapping[str, Any], physics: Physics, course: Curriculum) -> None:
        self._path, self._about, self._physics, self._course = path, about, physics, course
        self._due, self._waiting = 0.0, None

    def __call__(self, state: TrainingState) -> None:
        """Keep the state at the end of an epoch, on disk if it is time."""
        if self._path is not None:
            own = self._course.unknowns.scale, self._course.mean_square
            self._waiting = Snapshot(self._about, _copied(state), self._physics, *own)
            if time.monotonic() >= self._due:
                self.last()

    def last(self) -> None:
        """Write what is waiting."""
        if self._path is not None and self._waiting is not None:
            save_snapshot(self._path, self._waiting)
            self._waiting, self._due = None, time.monotonic() + SNAPSHOT_SECONDS


def _copied(state: TrainingState) -> TrainingState:
    """The state as it is now: an interrupted epoch must not change what waits to be written."""
    return replace(state, history=list(state.history))
