"""Outputs that are recorded later show at first what was before the record."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.delayed_input import after


def without_what_was_before(records: Any, rows: Mapping[str, int], late: Collection[tuple[Attachment, float]]) -> Any:
    """The records with outputs missing where they show what was before.

    Args:
        rows: the outputs' places by the names of their sensors.
        late: laws at sensors with a dead time each, in s.
    """
    y = np.array(records.y)
    for law, delay in late:
        row = rows[law.port]
        y[row] = np.where(after(records, law.mechanism.settling * delay), y[row], np.nan)
    return replace(records, y=y)
