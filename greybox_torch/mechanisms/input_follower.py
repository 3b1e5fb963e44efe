"""What acts instead of the recorded input and comes after it: the answer `unknown` at an actuator that remembers where it was."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.model import Signals, State

FOLLOWS = 0.5
"""Samples in which what acts comes after the input where nothing holds it: as fast as a step per sample integrates well."""

Drawn = tuple[str, str, np.ndarray, np.ndarray, str]
"""A curve: over which signal, its unit, the signal (N,), what is lacking there (N,), and the unit of that."""


class InputFollower(Mechanism):
    """What acts follows the input as far, or as fast, as a subclass lets it. At first it is what the input is."""

    kinds = ("actuator",)
    needs = ("input",)
    free = True
    signal = "input"
    modes = 1

    def states(self, around: Surroundings) -> list[State]:
        return [State("acts", around.units.get("input", ""))]

    def starts(self, s: Signals) -> dict[str, Any]:
        return {"acts": s.input}

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        return {"acts": self.rate(s.input - z.acts, p, FOLLOWS * s.sample_time)}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return z.acts - s.input

    def rate(self, ahead: Any, p: Signals, follows: float) -> Any:
        """Rate of what acts, in the input's unit per second, where the input is ``ahead`` of it; ``follows`` in s."""
        raise NotImplementedError

    def drawn(self, around: Surroundings, values: Mapping[str, float], points: int) -> Drawn:
        """What is lacking of the input, as a curve of about so many points."""
        raise NotImplementedError
