"""Numbers that loggers write where they have no value, known by the number itself: -9999 and its like."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

_NINES = re.compile(r"-?9{3,9}(\.9+)?")
_POWERS = tuple(float(f"{sign}1e{k}") for sign in ("", "-") for k in range(20, 39))
_OTHERS = frozenset((-999.25, 32767.0, -32768.0, 65535.0, 2147483647.0, -2147483648.0, 4294967295.0, *_POWERS))
"""Of logs of wells, the ends of integers, and numbers that nobody measures."""
_LEVELS = 10
"""Different values that a channel has besides, from which it is measured: one of a few levels may be commanded to any number."""
_SHARE = 0.5
"""Of the samples: up to which they may be missing."""


def is_error_code(value: float) -> bool:
    """Whether a number, as it stands in a file, is one of them, also where the file has it in single precision."""
    with np.errstate(over="ignore"):
        single = np.float32(value)
    texts = [f"{value:.10g}", *([str(single).removesuffix(".0")] if float(single) == value else [])]
    return any(float(text) in _OTHERS or _NINES.fullmatch(text) for text in texts)


def far_off(values: NDArray[np.float64]) -> Iterator[NDArray[np.intp]]:
    """Indices of the samples among values (N,) that are exactly at one end of their range and farther from all others than these are from
    each other, for each end: what an error code has to be. None of the values is missing.
    """
    for end in (values.min(), values.max()) if len(values) else ():
        at = values == end
        if np.count_nonzero(at) <= _SHARE * len(values):
            rest = values[~at]
            low, high = float(rest.min()), float(rest.max())
            if max(low - end, end - high) > high - low and len(np.unique(rest[:: len(rest) // 1000 + 1])) >= _LEVELS:
                yield np.flatnonzero(at)
