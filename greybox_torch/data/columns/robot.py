"""The columns of a robot's log: the numbers in the first message of every topic."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.data.columns.listing import MOST_COLUMNS, Listing
from greybox_torch.data.readers.mcap_log import mcap_log
from greybox_torch.data.readers.robot_log import TIME, RobotLog
from greybox_torch.data.readers.ros_bag import ros_bag
from greybox_torch.errors import UserError

_WIDEST = 64
"""Most elements of a list that are taken for channels; images and point clouds have more."""


def mcap_columns(path: Path) -> Listing:
    """Raises UserError, or what the package behind it raises for a damaged file."""
    return _listing(mcap_log(path))


def ros_bag_columns(path: Path) -> Listing:
    """Raises what SQLite raises for a damaged file."""
    return _listing(ros_bag(path))


def _listing(log: RobotLog) -> Listing:
    """The topic with most messages first; topics whose messages cannot be decoded are left out."""
    names: list[str] = []
    for topic in log.topics:
        try:
            first = next((log.decoders[topic](raw) for _, _, raw in log.messages([topic])), None)
        except UserError:
            continue
        if first is not None:
            names += [f"{topic}.{TIME}", *(f"{topic}{inner}" for inner in _numbers(first, ""))]
    return Listing(log.path, tuple(names[:MOST_COLUMNS]))


def _numbers(value: Any, prefix: str) -> Iterator[str]:
    fields = value if isinstance(value, Mapping) else getattr(value, "__dataclass_fields__", None)
    if fields is not None:
        for name in fields:
            if name not in ("header", "__msgtype__") and not (name == TIME and not prefix):
                inner = value[name] if isinstance(value, Mapping) else getattr(value, name)
                yield from _numbers(inner, f"{prefix}.{name}")
    elif isinstance(value, bool | int | float | np.number):
        yield prefix
    elif isinstance(value, list | tuple | np.ndarray) and len(value) <= _WIDEST:
        for k, inner in enumerate(value):
            yield from _numbers(inner, f"{prefix}[{k}]")
