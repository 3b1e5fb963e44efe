"""A law that comes to others at its actuator is tried behind them and before them."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.order import in_both_orders, joined
from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.mechanisms.actuator import InputDelay, InputGain, InputLag
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.unknown import Unknown

STEP, LAG, DEAD = 0.01, 0.12, 0.7


def lagged(u: np.ndarray) -> np.ndarray:
    """A first-order lag of a held input: its mean over every sample."""
    decay, now, mean = np.exp(-STEP / LAG), u[0], []
    for value in u:
        mean.append(value + (now - value) * LAG / STEP * (1 - decay))
        now = value + (now - value) * decay
    return np.array(mean)


def dead(u: np.ndarray) -> np.ndarray:
    return np.sign(u) * np.maximum(np.abs(u) - DEAD, 0.0)


@pytest.mark.parametrize("lag_first", [True, False])
def test_the_order_that_fits_is_found_whichever_law_was_found_first(motor_data, motor, begun, lag_first) -> None:
    """Seen: a limit of the voltage before the winding's lag, told as a lag of the speed's sensor (0.97)."""
    search = begun(motor_data(acting=lambda u: dead(lagged(u)) if lag_first else lagged(dead(u))), motor)
    zone, lag = attach(motor, "actuator", ActuatorDeadzone()), attach(motor, "actuator", InputLag())
    start = search.plain.values() | {f"{zone.prefix}.half_width": 0.8 * DEAD}
    found: SearchState = search.state.at(search.refitted((zone,), search.plain, [start]))
    known = found.current.values()
    candidate = Candidate(lag, ({**known, f"{lag.prefix}.T": 0.05},), 0.5)
    ranked = rank(search.study, found.current, [candidate])
    assert ranked[0].fitted.effects == ((lag, zone) if lag_first else (zone, lag))
    values = ranked[0].fitted.values()
    assert values[f"{lag.prefix}.T"] == pytest.approx(LAG, rel=0.1)
    assert values[f"{zone.prefix}.half_width"] == pytest.approx(DEAD, rel=0.1)
    other = search.refitted(ranked[0].fitted.effects[::-1], found.current, [values])
    assert other.score > ranked[0].fitted.score + 0.1


def test_only_where_the_order_matters(motor_data, motor, begun) -> None:
    study = begun(motor_data(), motor).study

    def at(law: object, port: str = "actuator") -> Candidate:
        return Candidate(attach(motor, port, law), (), 0.5)

    lag, zone, gain, delay = (at(law) for law in (InputLag(), ActuatorDeadzone(), InputGain(), InputDelay()))
    curve, friction = at(Unknown("input")), at(CoulombFriction(), "rotor")
    for there, comes, twice in (
        (zone, lag, True),
        (lag, zone, True),
        (lag, gain, False),
        (zone, delay, False),
        (delay, zone, False),
        (lag, curve, False),
        (zone, friction, False),
    ):
        tries = in_both_orders(study, (there.attachment,), [comes])
        assert [k.ahead for k in tries] == ([False, True] if twice else [False])
    assert in_both_orders(study, (), [lag, zone]) == [lag, zone]


def test_it_stands_before_those_at_its_actuator_alone(motor) -> None:
    friction, zone, gain, lag = (
        attach(motor, port, law)
        for port, law in (
            ("rotor", CoulombFriction()),
            ("actuator", ActuatorDeadzone()),
            ("actuator", InputGain()),
            ("actuator", InputLag()),
        )
    )
    behind, before = Candidate(lag, (), 0.5), Candidate(lag, (), 0.5, ahead=True)
    assert joined((friction, zone, gain), behind) == (friction, zone, gain, lag)
    assert joined((friction, zone, gain), before) == (friction, lag, zone, gain)
    assert joined((friction,), before) == (friction, lag)
