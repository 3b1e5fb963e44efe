"""The force that is missing at a port, and what repeats in it over the position."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.missing_force import MissingForce, missing_force
from greybox_torch.diagnosis.screen.position_spectrum import orders_over_position
from greybox_torch.diagnosis.screen.views import Views, views_of
from greybox_torch.estimate.equation_error import EquationError


@pytest.fixture(scope="module")
def views(rubbing) -> Views:
    found = views_of(rubbing.problem)
    assert isinstance(found, Views)
    return found


def test_a_known_force_is_recovered_to_the_noise(views) -> None:
    equations = views.equations.at(np.array([2.5, 0.8]))
    view = EquationError.of(equations, views.each[0].finest, None, False)
    found = missing_force(view, "sled")
    true = view.finest.mean(-1.5 * np.tanh(equations.states.numpy()[1] / 0.02))
    assert np.std(found.force - true) < 0.05 * 1.5
    assert found.signals["speed"].shape == found.signals["position"].shape == found.time.shape == found.force.shape
    assert missing_force(view, "actuator").force == pytest.approx(found.force), "the input is a force on the same mass"


def test_either_form_gives_start_values_of_the_parameters(views) -> None:
    starts = views.starts()
    assert len(starts) == 2
    assert all(set(s) == {"m", "c"} and 1.0 < s["m"] < 4.0 for s in starts)


def wavy(order: float, *, along_motion: bool = False, noise: float = 0.5) -> MissingForce:
    rng, n = np.random.default_rng(1), 6000
    t = np.linspace(0, 60, n)
    position = 8.0 * np.sin(0.3 * t) + 3.0 * np.sin(0.11 * t)
    speed = np.gradient(position, t)
    force = np.cos(order * position + 0.7) * (np.sign(speed) if along_motion else 1.0) + rng.normal(0, noise, n)
    experiment = (t > 30).astype(int)
    return MissingForce("rotor", force, {"position": position, "speed": speed}, t, experiment)


@pytest.mark.parametrize("order", [3.4, 17.3, 71.9])
@pytest.mark.parametrize("along_motion", [False, True])
def test_the_order_of_a_ripple_is_found_among_all(order: float, along_motion: bool) -> None:
    missing = wavy(order, along_motion=along_motion)
    found = orders_over_position(missing, 100.0, least_periods=5.0, count=2, with_motion=along_motion)
    assert found.best[0] == pytest.approx(order, abs=0.15)
    assert found.looked_at > 100


def test_orders_that_cannot_be_seen_to_repeat_are_not_looked_at() -> None:
    assert orders_over_position(wavy(3.0), 1.0, least_periods=5.0, count=2, with_motion=False).best == ()
    still = wavy(3.0)
    still = MissingForce(
        "rotor", still.force, {n: 0.0 * v for n, v in still.signals.items()}, still.time, still.experiment
    )
    assert orders_over_position(still, 100.0, least_periods=5.0, count=2, with_motion=False).best == ()
