"""How implausible a model's parameters are beside the card's values."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem

MOST_DECADES = 2.0
"""Decades beyond the first that count at most: of what vanishes, as damping that a machine does not have, no digit means anything."""


def implausibility(card: Problem, fitted: Problem, settings: DiagnosisSettings) -> float:
    """How much worse parameters are than the error that they leave: by the squares of the decades beyond the first from the card's values.

    What is missing may be taken up by parameters that no machine has, as windows have start states of their own. Seen: uneven friction of
    an arm's motor, of which nothing was said: with the arm's stiffness a hundred-thousandth of the card's windows left little.
    """
    values = fitted.values_by_name
    pairs = ((begun, abs(values[n])) for n, begun in card.values_by_name.items() if n in values)
    ratios = [now / abs(begun) for begun, now in pairs if begun != 0.0]
    decades = np.abs(np.log10(np.maximum(ratios, 1e-9))) - 1.0
    return settings.implausible_decade * float(np.sum(np.clip(decades, 0.0, MOST_DECADES) ** 2))
