"""Single numbers in the place of samples, in memory: a channel that has one value throughout a recording."""

from __future__ import annotations

from typing import Any

import numpy as np

from greybox_torch.data.checks import check_finite
from greybox_torch.errors import UserError


def is_number(value: Any) -> bool:
    """Whether it is one number and no array of them; an array without a dimension, and a tensor without one, are one too."""
    if isinstance(value, int | float | np.integer | np.floating):
        return not isinstance(value, bool)
    if getattr(value, "shape", None) != ():
        return False
    return np.asarray(_detached(value)).dtype.kind in "fiu"


def _detached(value: Any) -> Any:
    return value.detach().cpu() if hasattr(value, "detach") else value


def constant(place: str, channel: str, value: Any) -> float:
    """The value of a channel that has one throughout. Raises UserError, beginning with ``place``, for one that is none."""
    try:
        found = np.array([float(_detached(value))])
    except OverflowError:
        found = np.array([np.inf])
    check_finite(found, lambda _: f'{place}, channel "{channel}"')
    if np.isnan(found[0]):
        raise UserError(f'{place}, channel "{channel}": found nan, expected a number, or an array of N samples')
    return float(found[0])
