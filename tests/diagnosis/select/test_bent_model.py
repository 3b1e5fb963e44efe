"""Where the fit of the model as it stands is bent, the screen looks around the card's values, too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.select.bent_model import from_the_card, narrowed
from greybox_torch.diagnosis.select.offered import from_card
from greybox_torch.mechanisms.surroundings import Range, Surroundings


def around(reach: float, rms: float = 1.0) -> dict[str, Surroundings]:
    ranges = {"speed": Range(-reach, 0.5 * reach, rms), "position": Range(0.0, 2.0, 1.0)}
    return {"bit": Surroundings(ranges, {"speed": "rad/s"}, "N m", 0.01)}


@pytest.mark.parametrize(("reach", "kept"), [(412.0, False), (74.0, True), (3.0, True)])
def test_a_range_is_the_cards_where_the_fit_moves_much_farther(reach, kept) -> None:
    """Seen: a drill bit that nobody measures, at 412 rad/s in the bent model and 25 rad/s with the card's values."""
    found = narrowed(around(reach), around(25.0), 3.0)["bit"]
    assert found.ranges["speed"] == around(reach if kept else 25.0)["bit"].ranges["speed"]
    assert found.ranges["position"] == Range(0.0, 2.0, 1.0) and found.units == {"speed": "rad/s"}


def test_a_signal_that_rests_with_the_cards_values_tells_no_range() -> None:
    assert narrowed(around(412.0), around(1e-15, rms=0.0), 3.0) == around(412.0)


def test_windows_with_the_cards_values_have_fitted_start_states_alone(dead_zone_search) -> None:
    study, state = dead_zone_search.study, dead_zone_search.state
    fits, ranges = from_the_card(study, state.plain)
    assert len(fits) == len(state.plain.fits) and ranges is not None
    for fit, plain in zip(fits, state.plain.fits, strict=True):
        np.testing.assert_array_equal(fit.problem.values, study.problem.values)
        np.testing.assert_array_equal(fit.problem.free, plain.problem.free)
        assert fit.windows.steps == plain.windows.steps and fit.mean_square > plain.mean_square
    assert set(ranges) == set(study.surroundings)


def test_what_the_card_shows_is_offered_with_the_cards_values_to_the_first_step_alone(dead_zone_search) -> None:
    study, state = dead_zone_search.study, dead_zone_search.state
    assert study.at_card == () and from_card(study, state) == []
    bent = replace(study, at_card=from_the_card(study, state.plain)[0])
    offered = from_card(bent, state)
    dead_zone = next(c for c in offered if c.attachment.named == ("actuator", "actuator_deadzone"))
    assert all(start[n] == v for start in dead_zone.starts for n, v in study.card.items())
    assert 0.2 < dead_zone.starts[0]["actuator.actuator_deadzone.half_width"] < 1.0, "0.5 V"
    assert from_card(bent, replace(state, current=replace(state.current, effects=(dead_zone.attachment,)))) == []
