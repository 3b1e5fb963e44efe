"""Terms of a rate equation that is no mass: leaks and thresholds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import beyond
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals

TINY = 1e-12
"""Keeps a quotient finite at zero."""


class LinearLeak(Mechanism):
    """−c (level − reference): towards zero, or towards the level of a room or of a second vessel."""

    name = "linear_leak"
    kinds = ("balance",)
    needs = ("level",)
    generalises = ("constant_bias",)
    natural = ("reference",)
    nature = "a flow that depends on the level"
    explanation = (
        "Something leaks in proportion to how far the level is from a reference (heat loss to a room, seepage)."
    )
    source = "N. R. Kristensen, H. Madsen, S. B. Jørgensen, Automatica 40(2), 2004"
    experiment = "rest at several levels"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        level = around.ranges["level"]
        return [
            Parameter("c", 0.0, around.per("level"), lower=0.0, description="leak per level above the reference"),
            Parameter(
                "reference",
                0.0,
                around.units.get("level", ""),
                lower=min(0.0, level.low) - level.span,
                upper=max(0.0, level.low + level.span) + level.span,
                description="level at which nothing leaks",
            ),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.c * (s.level - p.reference)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        level = around.ranges["level"]
        references = dict.fromkeys((0.0, level.low, level.low + 0.5 * level.span))
        return [Probe(("c",), {"reference": reference}) for reference in references]


HALF_OF_ONSET, ONSET = 2.0, 4.0
"""Widths above the threshold, and in all, over which three quarters of a soft onset's bend lie (tanh 1 = 0.76)."""


class ThresholdFlow(Mechanism):
    """−c (level − threshold) above the threshold, where the flow sets in over a ``width`` w: −c w ln(1 + exp((level − threshold) / w)).

    Without a width it sets in at once.
    """

    name = "threshold_flow"
    kinds = ("balance",)
    needs = ("level",)
    later = ("width",)
    nature = "a flow that depends on the level"
    explanation = "Above a level something flows off (overflow, relief valve)."
    source = (
        "M. Schoukens, J. P. Noël, Three benchmarks addressing open challenges in nonlinear identification, IFAC 2017"
    )
    experiment = "levels just below and just above the threshold"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        level = around.ranges["level"]
        return [
            Parameter("c", 0.0, around.per("level"), lower=0.0, description="flow per level above the threshold"),
            Parameter(
                "threshold",
                level.low + 0.5 * level.span,
                around.units.get("level", ""),
                lower=level.low,
                upper=level.low + level.span,
                description="level at which the flow sets in",
            ),
            Parameter(
                "width",
                0.02 * level.span,
                around.units.get("level", ""),
                lower=0.0,
                upper=0.1 * level.span,
                description="range of levels over which it sets in",
            ),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        above = s.level - p.threshold
        setting_in = p.width * torch.log1p(torch.exp(-torch.abs(above) / (p.width + TINY)))
        return -p.c * (torch.clamp(above, min=0.0) + setting_in)

    def limit(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]]:
        """A leak: the threshold is below all levels, and nothing shows where the flow sets in."""
        return LinearLeak(), {"c": values["c"], "reference": values["threshold"]}

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        level = around.ranges["level"]
        places = (level.low + f * level.span for f in (0.3, 0.5, 0.7, 0.85, 0.95))
        return [Probe(("c",), {"threshold": place, "width": 0.02 * level.span}) for place in places]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return beyond("threshold", values["threshold"], around, "level") or self._bends_to_the_end(around, values)

    def acts_beyond(self, values: Mapping[str, float]) -> tuple[float | None, float | None] | None:
        return None, values["threshold"] - HALF_OF_ONSET * values.get("width", 0.0)

    def _bends_to_the_end(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        """The flow sets in over so much of the levels above the threshold that it is straight over less: a curve, and no threshold."""
        above = around.ranges["level"].high - values["threshold"]
        if values.get("width", 0.0) * (HALF_OF_ONSET + ONSET) <= above:
            return None
        return f"width = {values['width']:.3g} has the flow set in over most of the {above:.3g} that lie above the threshold"
