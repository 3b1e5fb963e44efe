"""The scale of a channel is asked about only where it explains more than the dry friction that the model lacks."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api import asked_of_channels, short_refits, with_friction
from greybox_torch.api.short_refits import Asked
from tests.api.rotor import recordings
from tests.api.test_with_friction import Drive

LEVEL, TORQUES = 4.0, (-8.0, 8.0)


class Known(Drive):
    """A drive of which the datasheet tells inertia and bearing, and the friction of its seal is forgotten."""

    parameters = (
        gt.Parameter("J", 0.3, unit="kg m^2", lower=0.2, upper=0.5),
        gt.Parameter("b", 0.1, unit="N m s/rad", lower=0.0, fixed=True),
    )


@pytest.mark.parametrize(("factor", "level", "asked"), [(1.0, LEVEL, ""), (30.0 / np.pi, 0.0, "the scale of speed")])
def test_friction_that_explains_more_is_no_scale(factor: float, level: float, asked: str) -> None:
    """Seen: "Is the scale of speed right? With values 9.55 times as large, a short refit reaches a mean fit of 30.4 %"; with friction
    alone it reaches 99 %.
    """
    data = recordings(level, torques=TORQUES, factor=factor)
    question = gt.fit(Known(), data).question
    assert (question is not None) is bool(asked), question
    assert question is None or asked in question


@pytest.mark.parametrize(("alone", "with_unit", "asked"), [(30.0, 95.0, True), (75.0, 95.0, False)])
def test_a_unit_beside_friction_explains_more_than_the_friction(
    alone: float, with_unit: float, asked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A factor that improves upon a friction which did nearly all is none to be asked about."""
    monkeypatch.setattr(with_friction, "_rubbing", lambda *given: (None, None))
    monkeypatch.setattr(with_friction, "as_it_is", lambda *given: alone)
    monkeypatch.setattr(with_friction, "nearest", lambda *given: [])
    found = lambda *given, **how: (100.0 - alone, [100.0 - with_unit] * len(given[3])) if given[3] else None  # noqa: E731
    monkeypatch.setattr(with_friction, "far_better", found)
    data = recordings(LEVEL, torques=TORQUES)
    for achieved in (0.0, -300.0, -np.inf):
        question = with_friction.changed_with_friction(data, Drive(), None, achieved)  # pyright: ignore[reportArgumentType]
        assert (question is not None) is asked


@pytest.mark.parametrize(("friction", "kept"), [(94.0, True), (97.0, False)])
def test_the_two_are_compared(friction: float, kept: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    question = Asked("Is the scale of torque right?", 95.0, "Is the scale of torque right?")
    monkeypatch.setattr(asked_of_channels, "rescaled", lambda *given: question)
    monkeypatch.setattr(with_friction, "_rubbing", lambda *given: (None, None))
    monkeypatch.setattr(with_friction, "fit_after", lambda *given, **how: friction)
    assert with_friction.AS_IT_IS is short_refits.AS_IT_IS
    data = recordings(LEVEL, torques=TORQUES)
    told = asked_of_channels._scale(data, Drive(), None, 20.0)  # pyright: ignore[reportArgumentType,reportPrivateUsage]
    assert (told == question) is kept
