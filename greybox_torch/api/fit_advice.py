"""What the free runs of an estimate say about the model itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.api.scores import Scores
from greybox_torch.estimate.comparison import Score

WORSE = 1.0
"""Points of the mean fit in % by which an estimate counts as worse than the values that it began with."""

DIAGNOSE = "`greybox diagnose` says what."


def fit_advice(scores: Scores) -> str | None:
    """A sentence where the estimate simulates the validation experiments badly, so that the model lacks something; else None.

    Args:
        scores: of the models "start" and "refit"; without validation experiments, those of estimation count.
    """
    before, after = (_mean_fit(scores[name]) for name in ("start", "refit"))
    on = "validation" if any(s.role == "validation" for s in scores["refit"]) else "estimation"
    if not np.isfinite(after):
        return None  # of a machine that is unstable by itself this says nothing
    if after <= 0.0:
        return (
            f"The estimate simulates the {on} experiments no better than a constant would (mean fit {after:.3g} %): the model lacks "
            f"something, or no free run follows this machine for long. {DIAGNOSE}"
        )
    if np.isfinite(before) and after < before - WORSE:
        return (
            f"The estimate simulates the {on} experiments worse than the values of the card (mean fit {after:.3g} % for {before:.3g} %): "
            f"its parameters make up for something that the model lacks. {DIAGNOSE}"
        )
    return None


def _mean_fit(scores: Sequence[Score]) -> float:
    """Mean fit in % over the validation experiments, or over all where there are none; minus infinity where a run overflows."""
    judging = [s for s in scores if s.role == "validation"] or list(scores)
    fits = [s.fit if np.isfinite(s.rmse) else -np.inf for s in judging if s.fit > -np.inf or not np.isfinite(s.rmse)]
    return float(np.mean(fits)) if fits else 0.0
