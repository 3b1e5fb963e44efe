"""How the estimates of the parameters depend on each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.uncertainty import Uncertainty

STRONG = 0.95
"""|correlation| from which two estimates are told to be hardly separable."""


@dataclass(frozen=True)
class CorrelationMatrix:
    """Correlations (d, d) of the estimates ``names``; NaN in the rows and columns of what the data do not determine."""

    names: tuple[str, ...]
    matrix: np.ndarray

    def strong_pairs(self, level: float = STRONG) -> list[tuple[str, str, float]]:
        """The pairs whose |correlation| exceeds ``level``, the strongest first."""
        pairs = [
            (self.names[i], self.names[j], float(self.matrix[i, j]))
            for i, j in zip(*np.triu_indices(len(self.names), 1), strict=True)
            if abs(self.matrix[i, j]) > level
        ]
        return sorted(pairs, key=lambda pair: -abs(pair[2]))


def correlation_matrix(names: tuple[str, ...], found: Uncertainty) -> CorrelationMatrix:
    """Of the free parameters ``names``, the first unknowns of ``found``, whatever the start states are.

    The covariance is σ² (JᵀJ)⁻¹: its correlations are a property of model and experiment, not of the residuals' colour.
    """
    size = len(names)
    covariance = found.plain[:size, :size]
    deviations = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    deviations[[i for i in found.undetermined if i < size]] = np.nan
    deviations[deviations == 0.0] = np.nan
    matrix = np.clip(covariance / np.outer(deviations, deviations), -1.0, 1.0)
    return CorrelationMatrix(names, matrix)
