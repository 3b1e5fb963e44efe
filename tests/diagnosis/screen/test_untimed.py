"""No delay and no lag of an output where nothing tells when it should have moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag


@pytest.mark.parametrize(("push", "late"), [(1.0, True), (0.0, False)])
def test_a_delay_is_offered_where_an_input_moves(data_set, motor, begun, push, late) -> None:
    """Seen: a wheel that coasts down, complete as it was, whose sensor was said to be 25 s late (0.97); a car's, whose viscous friction was
    told as a lag of 9.7 s.
    """
    voltage = push * np.repeat([0.0, 1.0, -1.0, 2.0], 100)
    speed = np.exp(-2.5 * 0.01 * np.arange(400)) + 0.2 * push * voltage
    recorded = {"voltage": voltage, "speed": speed + np.random.default_rng(0).normal(0.0, 0.01, 400)}
    search = begun(data_set({"voltage": "V", "speed": "rad/s"}, [recorded, recorded], sample_time=0.01), motor)
    laws = [a.mechanism for a in candidates(motor, {}, search.surroundings, flexible=False)]
    assert any(isinstance(law, OutputDelay) for law in laws) is late
    assert any(isinstance(law, SensorLag) for law in laws) is late
    around = search.surroundings["sensor"]
    assert around.timed is late and all(
        law.available(replace(around, timed=True)) for law in (OutputDelay(), SensorLag(True))
    )
