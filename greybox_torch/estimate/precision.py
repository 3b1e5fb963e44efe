"""Single or double precision, and what the estimation asks of either."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.estimate.levenberg_marquardt import Settings

PRECISIONS = ("double", "single")
"""float64 and float32."""

FINEST_TOLERANCE = {"double": 0.0, "single": 1e-6}
"""Relative change of the cost below which rounding speaks: in float32 a sum of some ten thousand squares is good to about 1e-5, and a step
counts as none where it promises less than a hundredth of the tolerance."""


def settings_for(precision: str, settings: Settings) -> Settings:
    """``settings`` with a tolerance that the precision can keep."""
    return replace(settings, tolerance=max(settings.tolerance, FINEST_TOLERANCE[precision]))
