"""What an unknown effect remembers, in the form of the verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from greybox_torch.diagnosis.digits import digits


@dataclass(frozen=True)
class Memory:
    """The response of an unknown effect from one signal to the force, with ``states`` hidden states.

    ``curved``: a free curve of the signal stands in front, and the response is what becomes of that.

    It remembers for ``seconds``, its longest time constant, known to ``deviation`` (None where it is not known). ``gain`` (F,) is complex,
    in the force's unit per the signal's (``unit``), at ``frequency`` (F,) in Hz; ``spread`` (F,) and ``turned`` (F,) are one standard
    deviation of its amplitude and of its phase in rad.
    """

    signal: str
    unit: str
    curved: bool
    states: int
    seconds: float
    deviation: float | None
    frequency: np.ndarray
    gain: np.ndarray
    spread: np.ndarray
    turned: np.ndarray

    @property
    def told(self) -> str:
        """How long it remembers, as a sentence has it."""
        return f"with a memory of about {digits(self.seconds)} s"

    @property
    def phase(self) -> np.ndarray:
        """Phase (F,) in rad, without jumps."""
        return np.unwrap(np.angle(self.gain))

    def as_json(self) -> dict[str, Any]:
        """Its entry `memory`; phases in degrees."""
        columns = {
            "frequency": self.frequency,
            "gain": np.abs(self.gain),
            "gain_std": self.spread,
            "phase": np.degrees(self.phase),
            "phase_std": np.degrees(self.turned),
        }
        return {
            "seconds": self.seconds,
            "std": self.deviation,
            "states": self.states,
            "behind_curve": self.curved,
            "signal": self.signal,
            "unit": self.unit,
            "response": {name: [float(v) for v in values] for name, values in columns.items()},
        }
