from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.estimate.correlation import correlation_matrix
from greybox_torch.estimate.uncertainty import Uncertainty

COVARIANCE = (
    np.diag([2.0, 5.0, 0.1]) @ np.array([[1, 0.99, 0.2], [0.99, 1, -0.3], [0.2, -0.3, 1]]) @ np.diag([2, 5, 0.1])
)


def test_correlations_whatever_the_units() -> None:
    found = correlation_matrix(("J", "b"), Uncertainty(COVARIANCE, COVARIANCE, ()))
    np.testing.assert_allclose(found.matrix, [[1.0, 0.99], [0.99, 1.0]])
    assert found.strong_pairs() == [("J", "b", pytest.approx(0.99))]
    assert found.strong_pairs(0.995) == []


def test_what_is_not_determined_has_none() -> None:
    found = correlation_matrix(("J", "b", "c"), Uncertainty(COVARIANCE, COVARIANCE, (1,)))
    assert np.isnan(found.matrix[1]).all()
    assert np.isnan(found.matrix[:, 1]).all()
    assert found.matrix[0, 2] == pytest.approx(0.2)
    assert found.strong_pairs() == []
