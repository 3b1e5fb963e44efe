"""Thresholds of what windows leave open, and held-out experiments are to decide."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import SIGMA, number, share


@dataclass(frozen=True, kw_only=True)
class HeldOutDecidesSettings:
    """Windows whose errors differ by orders of magnitude, as at rest and in motion, leave much open."""

    least_share_of_doubtful: float = share(
        0.75,
        "Share of the error that a law must remove to be taken though windows do not show it surely: held-out experiments then decide.",
        unit="share of the mean squared error over windows",
        chosen_by="chance: a curve removed up to 0.8 of two tanks' error, a law less",
    )
    least_significance_of_doubtful: float = number(
        2.0,
        "By how much, over windows, such a law must improve the prediction.",
        unit=SIGMA,
        chosen_by="convention",
    )
