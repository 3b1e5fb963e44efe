"""Play between the recorded input and what acts."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.memory import settled_curve
from greybox_torch.mechanisms.unknown_play import UnknownPlay
from tests.mechanisms.adding_tank import AROUND, DT, fitted, levels, ports_asked, tank_with

HALF = 0.2


def played(u: np.ndarray, half: float) -> np.ndarray:
    """The play operator, sample by sample."""
    acts = [u[0]]
    for now in u[1:]:
        acts.append(min(max(acts[-1], now - half), now + half))
    return np.array(acts)


@pytest.mark.parametrize("seed", range(3))
def test_what_acts_is_what_the_play_operator_gives(seed: int) -> None:
    """Steps held for a second, of which a Tank of no other dynamics adds up what acts."""
    u = np.repeat(np.random.default_rng(seed).uniform(-1, 1, 30), 10)
    found, truth = (
        levels(tank_with(UnknownPlay(), h=HALF), u),
        np.concatenate([[0.0], np.cumsum(played(u, HALF)[:-1]) * DT]),
    )
    without = np.concatenate([[0.0], np.cumsum(u[:-1]) * DT])
    # what follows half a sample late lacks half a sample of each step that gets through
    assert np.abs(found - truth).max() < 0.5 * DT * np.abs(np.diff(played(u, HALF))).max() + 1e-6
    assert np.abs(without - truth).max() > 3 * np.abs(found - truth).max()


def test_it_is_asked_for_at_actuators_among_what_remembers() -> None:
    assert ports_asked(UnknownPlay) == ["actuator"]
    assert not ports_asked(UnknownPlay, 14)


def test_its_curve_is_the_loop_that_it_draws() -> None:
    attachment = tank_with(UnknownPlay(), h=HALF).attachments[0]
    curve = settled_curve(attachment, AROUND, fitted("unknown_play", {"h": HALF}))
    assert curve is not None and curve.signal == "input" and curve.force_unit == "m/s"
    rising = np.diff(curve.values) > 0
    np.testing.assert_allclose(curve.force[:-1][rising], -HALF)
    np.testing.assert_allclose(curve.force[1:][~rising], HALF)


def test_play_as_wide_as_the_motion_is_refused() -> None:
    play = UnknownPlay()
    assert play.misplaced(AROUND, {"h": 0.5}) is None
    assert "a third of how far the input moved" in str(play.misplaced(AROUND, {"h": 0.8}))
