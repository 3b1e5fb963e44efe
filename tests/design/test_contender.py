"""Draws of a hypothesis' parameters."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np

from greybox_torch.experiment_design.contender import Contender


def test_parameters_of_very_different_units_are_drawn_without_a_warning() -> None:
    """Seen: a warning of NumPy's on the screen of a design, whose covariance was positive but for its last digits."""
    rng, scale = np.random.default_rng(0), np.array([1e-6, 1.0, 1e5, 1e-3])
    rows = rng.normal(size=(2, 4))
    information = (rows.T @ rows + 1e-9 * np.eye(4)) * np.outer(scale, scale)
    problem = SimpleNamespace(values=np.zeros(4), lower=-np.inf, upper=np.inf, admissible=lambda values: True)
    one: Any = SimpleNamespace(free=np.arange(4), problem=problem, information=information, at=lambda values: values)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn: Any = Contender.drawn(one, rng)
    assert np.isfinite(drawn).all() and (np.abs(drawn) > 0).all()
