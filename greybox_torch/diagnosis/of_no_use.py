"""A model that simulates the validation experiments worse than a constant would, whatever was found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.estimate.comparison import Score, mean_fit
from greybox_torch.estimate.metrics import told_fit


def of_no_use(scores: Sequence[Score], effects: bool) -> tuple[str, ...]:
    """A sentence where the mean fit of the recommended model on the validation experiments is negative; none elsewhere.

    A law may explain most of the error over windows, which begin anew, and a free run of it still go elsewhere. Seen: "94.9 % of the
    mismatch explained" beside a validation fit of -94 %, and not a word of it. A slip on the card, which the search takes as given, leads
    there as well: with a torque of the other sign a drive ran the other way, and no law explained that.
    """
    judging = [s for s in scores if s.role == "validation"]
    fit = mean_fit(judging) if judging else 0.0
    if fit >= 0.0:
        return ()
    which = "The model with what was found" if effects else "The model as it stands, re-estimated,"
    how = f"validation fit {told_fit(fit, 1)}" if np.isfinite(fit) else "a run of it overflows"
    whatever = ", though it explains much of the error over short windows" if effects else ""
    return (
        f"{which} simulates the validation experiments worse than a constant would ({how}): it is of no use for predicting them{whatever}. "
        "A column may have another sign, scale or meaning than the card says, or a term of the equations the wrong sign.",
    )
