"""A limit of how fast an actuator follows its input."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.memory import settled_curve
from greybox_torch.mechanisms.unknown_rate_limit import UnknownRateLimit
from tests.mechanisms.adding_tank import AROUND, DT, fitted, levels, ports_asked, tank_with

LIMIT = 0.5


def limited(u: np.ndarray, limit: float) -> np.ndarray:
    """What acts in the middle of each sample, where the input is held: it runs towards it in a straight line."""
    acts, fine = [u[0]], 100
    for now in u:
        for _ in range(fine):
            acts.append(acts[-1] + float(np.clip(now - acts[-1], -limit * DT / fine, limit * DT / fine)))
    return np.array([np.mean(acts[k * fine : (k + 1) * fine]) for k in range(len(u))])


@pytest.mark.parametrize("seed", range(3))
def test_what_acts_runs_towards_the_input_at_the_limit(seed: int) -> None:
    u = np.repeat(np.random.default_rng(seed).uniform(-1, 1, 12), 30)
    found = levels(tank_with(UnknownRateLimit(), R=LIMIT), u)
    truth = np.concatenate([[0.0], np.cumsum(limited(u, LIMIT)[:-1]) * DT])
    without = np.concatenate([[0.0], np.cumsum(u[:-1]) * DT])
    # at each of twelve steps the instant at which it arrives is met to within a sample
    assert np.abs(found - truth).max() < 12 * LIMIT * DT**2
    assert np.abs(without - truth).max() > 10 * np.abs(found - truth).max()


def test_it_is_asked_for_at_actuators_among_what_remembers() -> None:
    assert ports_asked(UnknownRateLimit) == ["actuator"]


def test_its_curve_is_what_the_limit_lacks_over_the_rate_of_the_input() -> None:
    attachment = tank_with(UnknownRateLimit(), R=LIMIT).attachments[0]
    curve = settled_curve(attachment, AROUND, fitted("unknown_rate_limit", {"R": LIMIT}))
    assert curve is not None and curve.signal == "rate of the input" and curve.unit == curve.force_unit == "m/s/s"
    np.testing.assert_allclose(curve.force, np.sign(curve.values) * np.minimum(LIMIT - np.abs(curve.values), 0.0))


def test_a_limit_that_is_never_reached_is_refused() -> None:
    law = UnknownRateLimit()
    assert law.misplaced(AROUND, {"R": LIMIT}) is None
    assert "within a sample" in str(law.misplaced(AROUND, {"R": 2.0 / DT}))
