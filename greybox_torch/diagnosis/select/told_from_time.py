"""A law over time on machines whose speed only falls: a law of the speed may be meant."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.select.all_that_is_left import Limit
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.simulation.records import Records

ONE_WAY = 0.98
"""Rank correlation with time, in absolute value, from which a signal has gone one way along a recording."""


def limited_by_time(signals: Mapping[str, np.ndarray], records: Records, settings: DiagnosisSettings) -> Limit | None:
    """What limits a law over time and another signal, where that signal goes one way along every recording; None for other laws.

    Over each such recording a law of the one is a law of the other. Seen: a drum and a wheel that coast down, whose drag was told as a
    friction that grows as the machine warms up (0.85).

    Args:
        signals: those that the law depends on, along the records (N,).
    """
    if "time" not in signals:
        return None
    for name, values in signals.items():
        if name != "time" and all(_one_way(values[records.span(e)]) for e in range(len(records.first))):
            return Limit(
                settings.highest_probability_where_most_is_left,
                f"along every recording {name} goes one way with time: a law of {name} may be meant",
            )
    return None


def _one_way(values: np.ndarray) -> bool:
    if len(values) < 2 or np.ptp(values) == 0:
        return False
    ranks = np.argsort(np.argsort(values))
    return bool(abs(np.corrcoef(ranks, np.arange(len(values)))[0, 1]) >= ONE_WAY)
