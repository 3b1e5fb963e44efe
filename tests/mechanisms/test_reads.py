"""Whether a law can be drawn over one signal."""

from __future__ import annotations

import pytest

from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.reads import reads_nothing_but
from greybox_torch.mechanisms.stiffness import NonlinearStiffness
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission import Backlash

MOVED = Range(-1.0, 1.0, 0.5)


def around(*signals: str) -> Surroundings:
    return Surroundings(dict.fromkeys(signals, MOVED), dict.fromkeys(signals, "rad"), "N m", 0.01)


@pytest.mark.parametrize(
    ("law", "signals", "signal", "alone"),
    [
        (CoulombFriction(), ("speed", "position"), "speed", True),
        (CoulombFriction(), ("speed", "position"), "position", False),
        (TorqueRipple(), ("speed", "position"), "position", True),
        (EndStop(), ("speed", "position"), "position", False),
        (ConstantBias(), ("speed", "position"), "position", True),
        (NonlinearStiffness(), ("deflection", "rate"), "deflection", True),
    ],
)
def test_of_one_signal_alone_or_not(law, signals, signal, alone) -> None:
    assert reads_nothing_but(law, around(*signals), signal) is alone


def test_more_than_it_needs_where_that_is_known() -> None:
    """A gear's play needs the deflection; where the rate is known, its damping within the gap reads that as well."""
    assert set(Backlash().needs) <= {"deflection"}
    assert not reads_nothing_but(Backlash(), around("deflection", "rate"), "deflection")
