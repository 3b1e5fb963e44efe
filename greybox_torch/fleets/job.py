"""One data set of a fleet and how it is to be diagnosed: what is sent to a worker."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Choices:
    """What holds for the whole fleet, as the options of `greybox diagnose` say it.

    ``model`` is a built-in name or ``/…/file.py:Class``, None where the cards name theirs. ``settings`` by name go before those of a card;
    ``settings_from`` says in messages where they are from. ``time_limit`` in seconds for each data set.
    """

    model: str | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    settings_from: str = "settings"
    time_limit: float | None = None
    seed: int = 0
    device: str = "cpu"


@dataclass(frozen=True)
class Job:
    """The data set ``name``, described by ``card``; its results go to ``folder``. Both paths hold on every worker."""

    name: str
    card: Path
    folder: Path
    choices: Choices = Choices()
