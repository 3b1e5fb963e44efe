"""A gain that changes as its signal is used, and comes back at rest."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.memory import settled_curve
from greybox_torch.diagnosis.screen.candidates import memory_candidates
from greybox_torch.mechanisms.unknown_fading import UnknownFading
from tests.mechanisms.adding_tank import AROUND, DT, Tank, fitted, levels, tank_with

CHANGE, TIME, FASTER = -0.4, 3.0, 2.0


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("faster", [0.0, FASTER])
def test_a_load_that_stays_wears_it_as_the_solution_says(power: int, faster: float) -> None:
    """z of a signal u that is held: use / (1 + q use) (1 - exp(-t (1 + q use) / T))."""
    u, n = 0.6, 150
    model = tank_with(UnknownFading("input", power), change=CHANGE, T=TIME, q=faster)
    found = levels(model, np.full(n, u), added=0.0)
    use, t = u**power, DT * np.arange(n)  # AROUND's reach is one
    rate = (1.0 + faster * use) / TIME
    held = use / TIME / rate
    truth = u * t + CHANGE * held * u * (t - (1.0 - np.exp(-rate * t)) / rate)
    np.testing.assert_allclose(found, truth, rtol=0, atol=1e-6)
    assert np.abs(truth - u * t).max() > 0.1


def test_it_comes_back_at_rest() -> None:
    u = np.concatenate([np.ones(100), np.zeros(300), np.ones(100)])
    found = np.diff(levels(tank_with(UnknownFading("input"), change=CHANGE, T=TIME), u, added=0.0)) / DT
    assert found[0] == pytest.approx(1.0, abs=0.01)
    assert found[95] == pytest.approx(1.0 + CHANGE, abs=0.03)
    assert found[400] == pytest.approx(found[0], abs=0.01)


def test_it_is_asked_for_over_every_signal_of_a_curve_with_either_power() -> None:
    tank = Tank()
    around = {q.name: AROUND for q in tank.all_ports}
    found = [a for a in memory_candidates(tank, around) if isinstance(a.mechanism, UnknownFading)]
    assert {(a.port, a.mechanism.signal, a.mechanism.power) for a in found} == {
        (port, signal, power) for port, signal in (("tank", "level"), ("actuator", "input")) for power in (1, 2)
    }


@pytest.mark.parametrize("power", [1, 2])
def test_its_curve_is_the_force_once_it_is_settled(power: int) -> None:
    attachment = tank_with(UnknownFading("input", power)).attachments[0]
    values = {"change": CHANGE, "T": TIME, "q": FASTER, "reach": 1.0}
    curve = settled_curve(attachment, AROUND, fitted("unknown_fading", values))
    assert curve is not None
    use = np.abs(curve.values) ** power
    np.testing.assert_allclose(curve.force, CHANGE * use / (1 + FASTER * use) * curve.values)


def test_a_memory_far_longer_than_the_records_is_refused() -> None:
    law = UnknownFading("input")
    assert law.misplaced(AROUND, {"T": TIME}) is None
    assert "longer than the longest record" in str(law.misplaced(AROUND, {"T": 1e4}))
