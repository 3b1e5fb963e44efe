"""The folder of compiled steppers, and what is thrown out of it again.

A stepper takes some 40 kB, and a changed model makes new ones. So that the folder does not grow for ever, those that were not used for
longest are deleted: what lay unused for :data:`OLDEST_DAYS`, and whatever is beyond :data:`LARGEST_MB` in all. What is deleted is compiled
again when it is wanted.
"""

from __future__ import annotations

import os
import shutil
import time
from contextlib import suppress
from pathlib import Path

LARGEST_MB = 512.0
"""Of all steppers together, where ``$GREYBOX_CACHE_MB`` says nothing else."""

OLDEST_DAYS = 90.0
"""Since a stepper was last loaded."""

ABANDONED_HOURS = 2.0
"""From when on a folder in which something was compiled is one that was left when its process was killed."""


def cache_folder() -> Path:
    """Where compiled steppers are kept: ``$GREYBOX_CACHE``, else the user's cache folder."""
    default = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "greybox_torch"
    return Path(os.environ.get("GREYBOX_CACHE", default))


def used(file: Path) -> None:
    """Notes that a stepper was loaded now, as its time of change."""
    with suppress(OSError):  # of another user, or on a file system that cannot be written
        os.utime(file)


def prune(folder: Path) -> None:
    """Throws out what was not used for longest. Other processes may do the same at the same time, or load what is deleted."""
    now, total = time.time(), 0.0
    for changed, size, file in sorted(_found(folder), reverse=True):
        total += size
        if total > 1e6 * _largest_mb() or now - changed > 86400 * OLDEST_DAYS:
            with suppress(OSError):
                file.unlink()
    for left in folder.glob("tmp*/"):
        with suppress(OSError):
            if now - left.stat().st_mtime > 3600 * ABANDONED_HOURS:
                shutil.rmtree(left)


def _found(folder: Path) -> list[tuple[float, int, Path]]:
    """When every stepper was last used, its bytes, and where it is."""
    found = []
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):  # deleted meanwhile
                if entry.name.endswith(".so"):
                    told = entry.stat()
                    found.append((told.st_mtime, told.st_size, Path(entry.path)))
    return found


def _largest_mb() -> float:
    try:
        return max(0.0, float(os.environ.get("GREYBOX_CACHE_MB", LARGEST_MB)))
    except ValueError:
        return LARGEST_MB
