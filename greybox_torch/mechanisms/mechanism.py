"""What a mechanism is: a named law that can be attached to a port."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import at_a_bound, lost_in_its_deviation
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Parameter, Signals, State


@dataclass(frozen=True)
class Probe:
    """One look of the screen: the effect linearised at ``values`` in the parameters ``directions``, which are zero there.

    The name ``share`` stands for a factor on the whole effect, for laws that are not absent at any parameter value.
    """

    directions: tuple[str, ...]
    values: Mapping[str, float] = field(default_factory=dict)


SHARE = "share"

__all__ = ["SHARE", "Mechanism", "Probe", "Range", "Surroundings"]


class Mechanism:
    """A named law at a port of one of ``kinds``; subclasses are the hypothesis library, and users may add their own.

    Class attributes: ``name`` as verdicts say it; ``kinds`` of ports it fits; ``needs``, the signals it uses (an instance may choose them);
    ``explanation``, one sentence for the report; ``source`` in the literature. Attributes and methods stand in the order of this class.
    """

    name: ClassVar[str]
    kinds: ClassVar[tuple[str, ...]]
    needs: tuple[str, ...] = ()
    at_rest: ClassVar[tuple[str, ...]] = ()
    """Signals of ``needs`` that may be zero and leave a law of the others: a stop pushes back however slowly it is met."""
    links: tuple[str, ...] = ()
    """Bodies of a chain whose positions the law uses, as signals ``position@BODY``."""
    drives: tuple[str, ...] = ()
    """Further inputs of the model that a law at an actuator changes as well, as signals ``input@NAME``."""
    reads: tuple[str, ...] = ()
    """Signals from elsewhere that a law sees at whatever port: inputs of the model, ``input@NAME``, and what
    :func:`~greybox_torch.model.signals_elsewhere.signals_elsewhere` lists, ``position@BODY`` and ``level@BALANCE``."""
    drawn_over: ClassVar[str] = ""
    """The signal of ``needs`` that its figure is over, where that is not the first."""
    repeats: ClassVar[bool] = False
    """Whether it is a sum of waves over a position, of an ``order``, and its figure is over a turn."""
    by_rate: bool = False
    """Whether it reads ``rate@PORT``, which the forces of all other laws belong to."""
    kinematic: bool = False
    """Whether the law changes a coupling's deflection (:meth:`deflection`) instead of adding a force."""
    lasting: tuple[str, ...] = ()
    """States of its memory that may be left from before a record: what each begins with is estimated."""
    fades: ClassVar[bool] = False
    """Whether the memory is gone after a few samples, so that a window may begin with any."""
    settling: ClassVar[float] = 0.0
    """How many of its times T a window's errors do not count from where a record begins: what an output shows so far is from before it."""
    free: ClassVar[bool] = False
    """Whether it is no law but the answer `unknown`: whatever curve or response the recordings ask for."""
    linear: ClassVar[bool] = False
    """Whether signals pass through it linearly, so that a frequency response shows what it does."""
    generalises: tuple[str, ...] = ()
    """Mechanisms that this one contains: where it does no better than one of them, that one is meant."""
    includes: tuple[str, ...] = ()
    """Of these the ones whose whole force is a part of its own: beside it they would name the same friction twice."""
    twins: ClassVar[tuple[str, ...]] = ()
    """Mechanisms elsewhere that no recording of one input and one output tells from this one, however well it is fitted."""
    akin: ClassVar[tuple[str, ...]] = ()
    """Mechanisms elsewhere with the same parameters that do nearly the same: what one came to is a good start for the other."""
    essential: ClassVar[tuple[str, ...]] = ()
    """Amplitudes without which this would be another law; by default it is absent only where all are zero."""
    natural: ClassVar[tuple[str, ...]] = ()
    """Parameters whose bounds are ends that they may well have (``NAME``, ``NAME.lower`` or ``NAME.upper``); zero always is."""
    later: ClassVar[tuple[str, ...]] = ()
    """Parameters that the law did not have in models saved by an earlier version; they are zero there."""
    stands_for: tuple[str, ...] = ()
    """As a richer form: what a further effect at its port has to be named for this one law to be asked in the place of both."""
    scales: ClassVar[bool] = False
    """Whether it is a gain, with which every force that was found beside it becomes another one, too."""
    rubs: bool = False
    """Whether it is friction by the speed of its body alone: a body has one such friction, of which two laws are two parts."""
    springs: bool = False
    """Whether it is how a coupling's force answers its deflection: a coupling has one such answer, of which two laws are two parts."""
    nature: ClassVar[str] = ""
    """What it has in common with its look-alikes, as a noun, for a statement about several that cannot be told apart; of an unknown effect
    that is no curve over one signal, what it is."""
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

    def elsewhere(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        """Forces on other bodies by their names, for a law that acts at several with common parameters."""
        return {}

    def other_inputs(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        """For a law at an actuator, the changes of the further ``drives`` by their names."""
        return {}

    def deflection(self, s: Signals, p: Signals) -> Any:
        """For a kinematic law, the deflection that the spring sees."""
        raise NotImplementedError

    def loaded(self, deflection: np.ndarray, p: Mapping[str, float]) -> np.ndarray:
        """For a kinematic law, the deflections (W,) with which the spring sees ``deflection`` (W,), where that differs much."""
        return deflection

    def reaction(self, s: Signals, p: Signals) -> Any | None:
        """For a kinematic law that follows a body's position, the force on that body, if there is one."""
        return None

    def force_beside(self, s: Signals, p: Signals) -> Any | None:
        """For a kinematic law, the force on the coupling beside the changed deflection (a damper's, a stiffer contact's), if any."""
        return None

    def written_as_force(self) -> Mechanism | None:
        """For a kinematic law, the same as a force on the coupling, for where no state carries the change of deflection; or None."""
        return None

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        """The looks that the screen takes."""
        raise NotImplementedError

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        """What is wrong with a place, a length or a time among the fitted ``values``, given where the signals moved."""
        return None

    def degenerate(
        self, around: Surroundings, values: Mapping[str, float], deviations: Mapping[str, float]
    ) -> str | None:
        """In words why the fitted parameters describe nothing on the machine, or None where they may.

        An amplitude is smaller than its standard deviation, a place, length or time lies outside of what was travelled or recorded, or a
        parameter sits at a bound that is not its natural end.

        Args:
            values: by parameter name, in the parameters' units.
            deviations: standard deviations by parameter name, of those that were estimated.
        """
        return (
            lost_in_its_deviation(self.essential or self.amplitudes(around), values, deviations)
            or self.misplaced(around, values)
            or at_a_bound(self.parameters(around), values, self.natural_ends(around))
        )

    def absent(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        """In words that the law does nothing with these parameters, as its amplitudes are zero; None where it does something."""
        return lost_in_its_deviation(self.essential or self.amplitudes(around), values, {})

    def amplitudes(self, around: Surroundings) -> tuple[str, ...]:
        """The parameters that are zero where the law is absent; where no probe names any, all that are estimated."""
        directions = {name for probe in self.probes(around) for name in probe.directions} - {SHARE}
        return tuple(
            p.name for p in self.parameters(around) if p.name in directions or (not directions and not p.fixed)
        )

    def natural_ends(self, around: Surroundings) -> tuple[str, ...]:
        """The bounds that a parameter may sit at in such recordings; see :attr:`natural`."""
        return self.natural

    def nearest(
        self, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, weight: np.ndarray
    ) -> Mechanism:
        """The form of the law to begin with where a force (N,) was learned over local signals (N,), points counting by weight (N,)."""
        return self

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """Forms of the law with more parameters, and where to begin, for where it was found at ``values`` and more than noise is left."""
        return ()

    def plainer(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """The form with fewer parameters of which this one is a :meth:`richer` one, and where to begin it; None where there is none."""
        return None

    def as_two(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """Two laws of the same port that do together what this one does but at rest, and where they begin; empty where there are none."""
        return ()

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        """Where else a refit that came to ``values`` may begin, as its errors may have other minima; empty where nothing is known."""
        return ()

    def begun_as(self, contained: str, values: Mapping[str, float]) -> Mapping[str, float]:
        """Where the law begins as one that it contains, which was found at ``values``; empty where nothing is known."""
        return {}

    def contained_as(self, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        """Where a law that it contains may begin, each a start, as it was found at ``values`` itself; names that law lacks do not count."""
        return (values,)

    def limit(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """The law that it becomes at the end of a parameter's range, where that is another one's, and where to begin it."""
        return None

    def acts_beyond(self, values: Mapping[str, float]) -> tuple[float | None, float | None] | None:
        """Below and above which value of the first of its :meth:`signals` it acts alone (None: on no such side); None where anywhere."""
        return None

    def available(self, around: Surroundings) -> bool:
        """Whether the recordings have the signals that it needs."""
        return set(self.needs) - {"delayed"} <= set(around.ranges)

    @classmethod
    def described(cls) -> str:
        """The law as the first paragraph of the class's documentation has it; "" where there is none."""
        first = inspect.cleandoc(cls.__doc__ or "").split("\n\n")[0]
        return " ".join(first.replace("``", "").split()).rstrip(".")

    def described_here(self) -> str:
        """The law in words in the form that it has: :meth:`described`, but for laws that have several."""
        return self.described()

    def options(self) -> dict[str, Any]:
        """What the constructor was told, by argument, so that the same mechanism can be made again."""
        return {name: vars(self)[name] for name in inspect.signature(type(self)).parameters if name in vars(self)}

    def signals(self) -> tuple[str, ...]:
        """The local signals that the effect is a function of, for the report."""
        return tuple(n for n in self.needs if n != "time") or self.needs
