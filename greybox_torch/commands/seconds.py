"""Options in seconds, read before anything is done, with a message of our own for what is no number of them."""

from __future__ import annotations

import math
from collections.abc import Callable

from greybox_torch.errors import ArgumentError, Kind


def seconds(argument: str) -> Callable[[str], float]:
    """What reads the text of the option that is called like ``argument``; it raises ArgumentError for all but a finite number above 0."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not 0 < value < math.inf:
            raise ArgumentError(argument, Kind(text), "expected seconds, a number above 0")
        return value

    return read
