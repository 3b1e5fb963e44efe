"""The curve of an effect: its law over a signal, and what the data say in its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from greybox_torch.diagnosis.factor import Factor


@dataclass(frozen=True)
class FreeCurve:
    """What the data say in the place of a law: ``force`` (n,) over the values of its :class:`Curve`, with one standard deviation ``spread``
    (n,), NaN where the records hardly come; and the force ``asked`` (m,) by single stretches of so many ``samples``, at their mean signal
    ``at`` (m,).
    """

    force: np.ndarray
    spread: np.ndarray
    at: np.ndarray
    asked: np.ndarray
    samples: int


@dataclass(frozen=True)
class Curve:
    """The effect's own law: ``force`` (n,) over ``signal`` (n,); ``force_unit`` as at the port. ``spread`` (n,) one standard deviation.

    ``seen`` (b,): how many samples of the estimation records lie in each of b equal bins from the lowest to the highest of ``values``.
    """

    signal: str
    unit: str
    values: np.ndarray
    force: np.ndarray
    force_unit: str
    spread: np.ndarray | None = None
    free: FreeCurve | None = None
    seen: np.ndarray | None = None
    factor: Factor | None = None

    def as_json(self) -> dict[str, Any]:
        """Its entry `curve` of an effect that has no name."""
        return {
            "signal": self.signal,
            "unit": self.unit,
            "values": [float(v) for v in self.values],
            "force": [float(v) for v in self.force],
            "force_unit": self.force_unit,
            **({} if self.factor is None else self.factor.as_json()),
        }
