"""Start values that a law takes over from its twin, or from a law that it contains."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.refit.twins import from_contained, from_twin
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.mechanisms.actuator import InputDelay, InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction, ViscousFriction
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag
from greybox_torch.mechanisms.stribeck import StribeckFriction

EARLY, LATE, LAG = (
    Candidate(Attachment(port, law), (), 0.5)
    for port, law in (("actuator", InputDelay()), ("sensor", OutputDelay()), ("actuator", InputLag()))
)


@pytest.fixture
def reached(stub):
    """What a candidate came to: its score, and its values."""
    return lambda score, **values: stub(score=score, values=lambda: values)


def test_what_a_twin_came_to_is_a_start_where_it_is_clearly_better(reached) -> None:
    """Seen: a delay of 0.04 s that began at 0.2 s and stayed there, beside one of the output that began at 0.03 s and found it."""
    stuck = reached(-3.7, **{"J": 0.3, "actuator.input_delay.T": 0.198})
    found = reached(-5.1, **{"J": 0.2, "sensor.output_delay.T": 0.043})
    tried = [(EARLY, stuck), (LATE, found), (LAG, reached(-9.0, **{"actuator.input_lag.T": 0.06}))]
    start = from_twin(EARLY, stuck, tried, 0.03)
    assert start == {"J": 0.2, "actuator.input_delay.T": 0.043}
    assert from_twin(EARLY, None, tried, 0.03) == start  # also where it could not be fitted at all
    assert from_twin(LATE, found, tried, 0.03) == {}
    assert from_twin(LAG, tried[2][1], tried, 0.03) == {}  # a lag has no twin


def test_twins_that_tie_are_left_alone(reached) -> None:
    one, other = reached(-5.0), reached(-5.02, **{"sensor.output_delay.T": 0.04})
    assert from_twin(EARLY, one, [(EARLY, one), (LATE, other)], 0.03) == {}
    assert from_twin(EARLY, one, [(EARLY, one), (LATE, None)], 0.03) == {}


def test_a_lag_begins_where_that_of_the_other_end_came_to(reached) -> None:
    """Seen: an arm's input lag that its trial lost in a valley of the friction; one of the sensor was named in its place (0.97)."""
    late_lag = Candidate(Attachment("sensor", SensorLag()), (), 0.5)
    stuck = reached(-1.3, **{"J": 0.3, "actuator.input_lag.T": 0.002})
    found = reached(-5.3, **{"J": 0.2, "sensor.sensor_lag.T": 0.009})
    tried = [(LAG, stuck), (late_lag, found)]
    assert from_twin(LAG, stuck, tried, 0.03) == {"J": 0.2, "actuator.input_lag.T": 0.009}
    assert from_twin(late_lag, found, tried, 0.03) == {}
    assert not set(InputLag.twins) & {"sensor_lag"}, "well fitted, nonlinear friction tells them apart"


@pytest.mark.parametrize(
    ("law", "begun"),
    [(PreslidingHysteresis(), {"F": 0.05}), (StribeckFriction(), {"F_c": 0.05, "F_s": 0.0, "v_0": 0.09})],
)
def test_a_law_that_ends_worse_than_one_that_it_contains_begins_as_that(reached, law, begun) -> None:
    """Seen: bristles of a capper's motor, which left five times as much as its dry friction; begun as that, a fifth less."""
    wider, dry, viscous, elsewhere = (
        Candidate(Attachment(port, one), (), 0.5)
        for port, one in (
            ("motor", law),
            ("motor", CoulombFriction()),
            ("motor", ViscousFriction()),
            ("chuck", CoulombFriction()),
        )
    )
    stuck, found = (
        reached(-0.8),
        reached(-2.4, **{"J": 0.2, "motor.coulomb_friction.F_c": 0.05, "motor.coulomb_friction.v_0": 0.09}),
    )
    tried = [(wider, stuck), (dry, found), (viscous, reached(-3.0)), (elsewhere, reached(-3.0))]
    expected = {"J": 0.2} | {f"motor.{law.name}.{name}": value for name, value in begun.items()}
    assert from_contained(wider, stuck, tried, 0.03) == expected
    assert from_contained(wider, None, tried, 0.03) == expected
    assert from_contained(wider, reached(-2.39), tried, 0.03) == {}, "they tie"
    assert from_contained(dry, found, tried, 0.03) == {}
