"""What a report says of its own making, beside the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True)
class About:
    """Of the run: ``version`` of the package, when it ended, on which ``device``; whether the validation data were split off by default.

    Of the model that came out: ``values`` and ``units`` by parameter name, and the ``command`` that simulates with it.
    """

    version: str
    created: datetime
    device: str = "cpu"
    held_out_by_default: bool = False
    values: Mapping[str, float] | None = None
    units: Mapping[str, str] | None = None
    command: str = ""
