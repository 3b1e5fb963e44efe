"""The fixed-step stepper: windows side by side in one batch, with forward sensitivities.

Runge-Kutta of order four, with the input held between samples as the data set says and as many sub-steps as asked for.
"""

from __future__ import annotations

from typing import Protocol

from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records


class Stepper(Protocol):
    """What advances windows: compiled code where there is a compiler, torch operations everywhere."""

    @property
    def sensitive(self) -> tuple[str, ...]:
        """The parameters that tangents are propagated for, in the order of the directions."""
        ...

    @property
    def compiled(self) -> bool:
        """Whether a pass takes milliseconds rather than seconds."""
        ...

    def run(self, records: Records, asked: Pass, substeps: int = 1) -> Run:
        """Advance all windows by ``substeps`` Runge-Kutta steps per sample."""
        ...
