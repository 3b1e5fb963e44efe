"""Couplings between two masses: the kinematic error of a gear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from greybox_torch.mechanisms.degenerate import not_seen_to_repeat
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.waves import (
    HARMONICS,
    amplitudes_up_to,
    slope_of_waves,
    strongest_alone,
    wave_parameters,
    waves,
)
from greybox_torch.model import Parameter, Signals

REACTION = "share of the error's slope times the load that the driving body feels (1: all, 0: none)"


class TransmissionError(Mechanism):
    """The spring sees the deflection plus e(θ) = a cos nθ + b sin nθ, with θ the position of the driving body, and ``harmonics`` of it.

    A wheel off its centre gives the order of its turns, one that is oval twice that.

    By virtual work that body feels de/dθ times the spring's force as well; ``reaction`` is the share of it that acts (an error on the
    far side of a reduction reaches the near side divided by the ratio). The force is the load that the model says the body carries, or
    else what the model's spring transmits. Where the body's speed ω is known, the coupling's damper answers the rate of the error, with
    ``damping`` · e'(θ) ω. ``as_force``: what the spring makes of the error, as a force on the coupling, for a model in which no state
    reaches this spring alone (a twist from which the link's angle follows, by which a weight or another spring acts); the amplitudes are
    levels then, and what the driving body feels beyond them, which is small, is left out.
    """

    name = "transmission_error"
    kinds = ("coupling",)
    needs = ("deflection", "position")
    drawn_over = "position"
    repeats = True
    natural = ("reaction",)
    nature = "a coupling that is no linear spring"
    explanation = "The gear's output does not follow its input exactly: a kinematic error periodic in position."
    source = "T. Tuttle, W. Seering, IEEE Trans. Robotics and Automation 12(3), 1996"
    experiment = "slow constant speed over several turns, in both directions"

    def __init__(self, order: float = 1.0, harmonics: int = 1, as_force: bool = False) -> None:
        self.order, self.harmonics, self.as_force = order, harmonics, as_force
        self.kinematic = not as_force

    def parameters(self, around: Surroundings) -> list[Parameter]:
        if self.as_force:
            return wave_parameters(around, self.order, self.harmonics)
        unit = around.units.get("deflection", "")
        return [
            *wave_parameters(around, self.order, self.harmonics, unit),
            *(
                [
                    Parameter(
                        "damping", 0.0, around.per("rate"), lower=0.0, description="damper's answer to the error's rate"
                    )
                ]
                if "speed" in around.ranges
                else []
            ),
            *(
                [Parameter("reaction", 0.5, "", lower=0.0, upper=1.0, description=REACTION)]
                if self._reacts(around)
                else []
            ),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return waves(s.position, p, self.harmonics)

    def deflection(self, s: Signals, p: Signals) -> Any:
        return s.deflection + waves(s.position, p, self.harmonics)

    def reaction(self, s: Signals, p: Signals) -> Any:
        return -p.reaction * self._slope(s, p) * s.load if "reaction" in p and "load" in s else None

    def force_beside(self, s: Signals, p: Signals) -> Any:
        return p.damping * self._slope(s, p) * s.speed if "damping" in p and "speed" in s else None

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With harmonics of the order found."""
        if self.harmonics > 1:
            return ()
        return ((TransmissionError(values["order"], HARMONICS, self.as_force), dict(values)),)

    def plainer(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """Its strongest wave alone."""
        return strongest_alone(partial(TransmissionError, as_force=self.as_force), values, self.harmonics)

    def written_as_force(self) -> Mechanism:
        return TransmissionError(self.order, self.harmonics, as_force=True)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        if self.as_force:
            return [Probe(amplitudes_up_to(self.harmonics), {"order": self.order})]
        fixed = {"order": self.order, **({"damping": 0.0} if "speed" in around.ranges else {})}
        shares: list[dict[str, float]] = [{"reaction": 0.0}, {"reaction": 1.0}] if self._reacts(around) else [{}]
        return [Probe(amplitudes_up_to(self.harmonics), {**fixed, **share}) for share in shares]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return not_seen_to_repeat(values["order"], around)

    def _reacts(self, around: Surroundings) -> bool:
        return "load" in around.ranges

    def _slope(self, s: Signals, p: Signals) -> Any:
        """The slope de/dθ of the error."""
        return slope_of_waves(s.position, p, self.harmonics)
