"""What a mechanism is: a named law that can be attached to a port."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from greybox_torch.model import Parameter, Signals, State


@dataclass(frozen=True)
class Range:
    """Where a signal moved in the recordings: lowest and highest value, and root mean square, in its unit."""

    low: float
    high: float
    rms: float

    @property
    def reach(self) -> float:
        """The largest magnitude, never zero."""
        return max(abs(self.low), abs(self.high), 1e-12)

    @property
    def span(self) -> float:
        """From the lowest to the highest value, never zero."""
        return max(self.high - self.low, 1e-9 * self.reach)


@dataclass(frozen=True)
class Surroundings:
    """What a mechanism may know of the place it is attached to, to choose sensible ranges.

    ``ranges`` and ``units`` by signal name (``speed``, ``position``, ``load``, ``time``, ``deflection``, ``rate``, ``level``, ``input``,
    ``output``); ``force_unit`` of the port; ``sample_time`` in s.
    """

    ranges: Mapping[str, Range]
    units: Mapping[str, str]
    force_unit: str
    sample_time: float

    def per(self, signal: str, power: int = 1) -> str:
        """The unit of force per signal to a power."""
        unit = self.units.get(signal, "")
        return self.force_unit if not unit else f"{self.force_unit}/({unit})" + (f"^{power}" if power > 1 else "")


@dataclass(frozen=True)
class Probe:
    """One look of the screen: the effect linearised at ``values`` in the parameters ``directions``, which are zero there.

    The name ``share`` stands for a factor on the whole effect, for laws that are not absent at any parameter value.
    """

    directions: tuple[str, ...]
    values: Mapping[str, float] = field(default_factory=dict)


SHARE = "share"


class Mechanism:
    """A named law at a port of one of ``kinds``; subclasses are the hypothesis library, and users may add their own.

    Class attributes: ``name`` as verdicts say it; ``kinds`` of ports it fits; ``needs``, the signals it uses (an instance may choose them);
    ``explanation``, one sentence for the report; ``source`` in the literature. Attributes and methods stand in the order of this class.
    """

    name: ClassVar[str]
    kinds: ClassVar[tuple[str, ...]]
    needs: tuple[str, ...] = ()
    kinematic: ClassVar[bool] = False
    """Whether the law changes a coupling's deflection (:meth:`deflection`) instead of adding a force."""
    fades: ClassVar[bool] = False
    """Whether the memory is gone after a few samples, so that a window may begin with any."""
    generalises: ClassVar[tuple[str, ...]] = ()
    """Mechanisms that this one contains: where it does no better than one of them, that one is meant."""
    includes: ClassVar[tuple[str, ...]] = ()
    """Of these the ones whose whole force is a part of its own: beside it they would name the same friction twice."""
    twins: ClassVar[tuple[str, ...]] = ()
    """Mechanisms elsewhere that no recording of one input and one output tells from this one, however well it is fitted."""
    explanation: ClassVar[str] = ""
    source: ClassVar[str] = ""
    experiment: ClassVar[str] = ""
    """Which experiment would tell this mechanism from its look-alikes."""

    def parameters(self, around: Surroundings) -> list[Parameter]:
        """Physical parameters with units, bounds and start values, given where the signals moved."""
        raise NotImplementedError

    def states(self, around: Surroundings) -> list[State]:
        """Memory of the law, if it has any."""
        return []

    def starts(self, s: Signals) -> dict[str, Any]:
        """Memory states that do not begin at their declared value but as the local signals ``s`` say (a lag begins settled)."""
        return {}

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        """Rates of the memory states ``z``."""
        return {}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        """The extra generalised force (at an actuator or sensor: the change of the signal), from the local signals ``s``."""
        raise NotImplementedError

    def deflection(self, s: Signals, p: Signals) -> Any:
        """For a kinematic law, the deflection that the spring sees."""
        raise NotImplementedError

    def reaction(self, s: Signals, p: Signals) -> Any | None:
        """For a kinematic law that follows a body's position, the force on that body, if there is one."""
        return None

    def damped(self, s: Signals, p: Signals) -> Any | None:
        """For a kinematic law that moves with a body, the force on the coupling by which its damper answers the rate of the change."""
        return None

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        """The looks that the screen takes."""
        raise NotImplementedError

    def options(self) -> dict[str, Any]:
        """What the constructor was told, by argument, so that the same mechanism can be made again."""
        return {name: vars(self)[name] for name in inspect.signature(type(self)).parameters if name in vars(self)}

    def signals(self) -> tuple[str, ...]:
        """The local signals that the effect is a function of, for the report."""
        return tuple(n for n in self.needs if n != "time") or self.needs
