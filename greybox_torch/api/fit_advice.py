"""What the free runs of an estimate say about the model itself."""

from __future__ import annotations

import numpy as np

from greybox_torch.api.scores import Scores
from greybox_torch.estimate.comparison import held_out_scores, mean_fit, of_moving_outputs

WORSE = 1.0
"""Points of the mean fit in % by which an estimate counts as worse than the values that it began with."""

DIAGNOSE = "`greybox diagnose` says what."


def fit_advice(scores: Scores) -> str | None:
    """A sentence where the estimate simulates the validation experiments badly, so that the model lacks something; else None.

    Args:
        scores: of the models "start" and "refit"; without validation experiments, those of estimation count.
    """
    judging = {name: of_moving_outputs(held_out_scores(scores[name])) for name in ("start", "refit")}
    before, after = mean_fit(judging["start"]), mean_fit(judging["refit"])
    on = "validation" if any(s.role == "validation" for s in scores["refit"]) else "estimation"
    if not judging["refit"] or not np.isfinite(after):
        return None  # of a machine at rest, or unstable by itself, this says nothing
    if after <= 0.0:
        return (
            f"The estimate simulates the {on} experiments no better than a constant would (mean fit {after:.3g} %): a column has another "
            "sign, unit or meaning than the card says (`greybox inspect` draws them), the model lacks something, or no free run follows "
            f"this machine for long. {DIAGNOSE}"
        )
    if np.isfinite(before) and after < before - WORSE:
        return (
            f"The estimate simulates the {on} experiments worse than the values of the card (mean fit {after:.3g} % for {before:.3g} %): "
            f"its parameters make up for something that the model lacks. {DIAGNOSE}"
        )
    return None
