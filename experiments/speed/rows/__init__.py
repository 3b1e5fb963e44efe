"""The rows of the comparison, by the name that `--only` takes. Each module measures one and says what it needs."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from experiments.speed.row import Row, skipped
from experiments.speed.settings import ALL_FREE_CARD, PUBLISHED_CARD, SHARED, Settings, missing_peers

KEYS = (
    "free_run",
    "sensitivities",
    "estimation",
    "fresh_process",
    "network_gradient",
    "growth",
    "hypotheses",
    "robustness",
    "diagnosis",
    "long_record",
)

Progress = Callable[[str], None]
"""Called with one line about what is being measured."""


@dataclass(frozen=True)
class Needs:
    """What a row cannot do without: modules of the extra `[peers]`, and the recordings of the real arm."""

    peers: tuple[str, ...] = ()
    recordings: bool = False


def measure(key: str, settings: Settings, progress: Progress) -> Row:
    """The row called ``key``; where something that it needs is absent, a row that says what."""
    module = importlib.import_module(f"experiments.speed.rows.{key}")
    reason = _absent(module)
    return skipped(key, module.TITLE, reason) if reason else module.measure(settings, progress)


def _absent(module: ModuleType) -> str:
    needs: Needs = module.NEEDS
    missing = missing_peers(needs.peers)
    if missing:
        return f"{' and '.join(missing)} not installed: install the extra [peers], `pip install -e '.[peers]'`"
    if needs.recordings and not recordings_present():
        return "the recordings of the real arm (../shared/recordings/robot_arm beside the checkout) are not here"
    return ""


def recordings_present() -> bool:
    """Whether the real arm's recordings are beside the checkout."""
    wanted: tuple[Path, ...] = (PUBLISHED_CARD, ALL_FREE_CARD, SHARED / "recordings" / "robot_arm" / "RobotArm.mat")
    return all(path.exists() for path in wanted)
