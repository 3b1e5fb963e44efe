"""Dry friction that surely changes its sign over many speeds is none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import degenerate
from greybox_torch.diagnosis.hypothesis.degenerate import grows_with_speed
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Range, Surroundings

AROUND = {"roller": Surroundings({"speed": Range(-50.0, 40.0, 20.0)}, {"speed": "rad/s"}, "N m", 0.01)}
FRICTION = Attachment("roller", CoulombFriction())


@pytest.fixture
def fitted(stub, monkeypatch) -> Any:
    """A hypothesis whose width is known with a deviation; the level trades with it a little."""

    def make(
        width: float, deviation: float | None, effect: Attachment = FRICTION, times: float = 3.0, known: bool = True
    ) -> Any:
        monkeypatch.setattr(degenerate, "floor_known", lambda problem, settings: known)
        monkeypatch.setattr(degenerate, "times_noise", lambda problem, fitted, settings: times)
        information = np.linalg.inv(np.array([[1.0, 0.1], [0.1, 1.0]]) * ((deviation or 1.0) / 0.2) ** 2)
        monkeypatch.setattr(
            degenerate, "window_information", lambda fit, simulator: None if deviation is None else information
        )
        names = (f"{effect.prefix}.F_c", f"{effect.prefix}.v_0")
        problem, values = stub(free_names=names), dict(zip(names, (2.0, width), strict=True))
        return stub(problem=problem, values=lambda: values, fits=[stub(mean_square=0.04)], simulator=None)

    return make


@pytest.mark.parametrize(
    ("width", "deviation", "grows"),
    [(4.6, 0.3, True), (5.0, 0.1, True), (5.0, 1.3, False), (2.9, 0.05, False), (0.5, 0.01, False), (5.0, None, False)],
)
def test_a_width_beyond_that_of_dry_friction_counts_where_it_is_determined(fitted, width, deviation, grows) -> None:
    """Seen: eddy-current brakes, 9.3 +- 0.6 and 10 % of the fastest speed; dry friction near the noise, 10 +- 2.5 %."""
    assert grows_with_speed(fitted(width, deviation), FRICTION, AROUND, DiagnosisSettings()) is grows


def test_nor_does_a_width_with_which_noise_alone_is_left(fitted) -> None:
    assert not grows_with_speed(fitted(4.6, 0.3, times=1.02), FRICTION, AROUND, DiagnosisSettings())


def test_where_the_noise_is_only_bounded_it_may_not_be_alone(fitted) -> None:
    """Seen: a flywheel's brake, told as dry friction (0.97) at 0.9 times a bound of the noise; a curve left half of that."""
    assert grows_with_speed(fitted(4.6, 0.3, times=0.9, known=False), FRICTION, AROUND, DiagnosisSettings())


def test_what_does_not_rub_has_no_width(fitted) -> None:
    bias = Attachment("roller", ConstantBias())
    assert not grows_with_speed(fitted(5.0, 0.1, bias), bias, AROUND, DiagnosisSettings())


def test_nor_has_friction_whose_width_is_fixed(fitted) -> None:
    found = fitted(5.0, 0.1)
    found.problem.free_names = found.problem.free_names[:1]
    assert not grows_with_speed(found, FRICTION, AROUND, DiagnosisSettings())
