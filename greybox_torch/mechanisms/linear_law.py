"""Laws with one parameter, which they are proportional to: declared by class attributes and one formula."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals


@dataclass(frozen=True)
class Per:
    """The unit of the port's force per ``signal`` to a ``power``; per nothing, the force itself."""

    signal: str = ""
    power: int = 1

    def unit(self, around: Surroundings) -> str:
        return around.per(self.signal, self.power) if self.signal else around.force_unit


@dataclass(frozen=True)
class Of:
    """The unit of a ``signal`` at the port; of nothing, a pure number."""

    signal: str = ""

    def unit(self, around: Surroundings) -> str:
        return around.units.get(self.signal, "") if self.signal else ""


class LinearLaw(Mechanism):
    """A law without memory that is proportional to its one parameter, and absent where that is zero.

    A subclass writes :meth:`law` and says by class attributes what the parameter is: its name ``parameter``, ``measured_in`` (its
    unit, :class:`Per` or :class:`Of`), ``lower`` and ``upper`` bound, and ``description``, for instance::

        class QuadraticDrag(LinearLaw):
            parameter, measured_in, lower, description = "c", Per("speed", 2), 0.0, "drag coefficient"

            def law(self, s, size):
                return -size * s.speed * torch.abs(s.speed)
    """

    parameter: ClassVar[str]
    measured_in: ClassVar[Per | Of] = Per()
    lower: ClassVar[float | None] = None
    upper: ClassVar[float | None] = None
    description: ClassVar[str]

    def law(self, s: Signals, size: Any) -> Any:
        """The force for a parameter ``size``, from the local signals ``s``."""
        raise NotImplementedError

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [self.size(around)]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return self.law(s, p[self.parameter])

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((self.parameter,))]

    def size(self, around: Surroundings) -> Parameter:
        """The parameter itself, zero to begin with."""
        unit = self.measured_in.unit(around)
        return Parameter(self.parameter, 0.0, unit, lower=self.lower, upper=self.upper, description=self.description)
