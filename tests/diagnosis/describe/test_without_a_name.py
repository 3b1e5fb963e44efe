"""An error that nothing explains: missing physics, or a disturbance that nobody measured."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.residual_tests import Detection, Largest, Remains
from greybox_torch.diagnosis.describe.without_a_name import is_missing
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()


def detection(past: float) -> Detection:
    """Errors whose correlation with past inputs is ``past``, where 0.1 is chance."""
    remains = Remains(Largest(0.9, 0.05), Largest(past, 0.1))
    return Detection("run", "speed", remains, remains, Largest(0.0, 0.1), 10.0)


@pytest.mark.parametrize(
    ("error", "chosen_by", "past", "complete", "missing"),
    [
        (None, 1.0, 0.5, True, False),
        (5.3, 2.9, 0.02, True, False),
        (5.3, 2.9, 0.3, True, True),
        (5.3, 2.9, 0.02, False, True),
        (5.3, 1.0, 0.02, True, True),
        (36.0, 30.0, 0.02, True, True),
    ],
    ids=["at the noise", "a disturbance", "follows inputs", "stopped", "shown by others alone", "large"],
)
def test_what_no_law_explains_is_missing_where_it_repeats_or_is_large(
    error, chosen_by, past, complete, missing
) -> None:
    assert is_missing(error, chosen_by, [detection(past)], complete, SETTINGS) is missing


def test_a_random_load_on_a_complete_model_is_no_missing_physics(motor_data, motor, monkeypatch) -> None:
    """Seen: a pump whose impeller was loaded at random, 5 times the noise: "something is missing"."""

    def nothing_found(study, state):
        yield state
        return state

    rng, load = np.random.default_rng(8), [0.0]

    def torque(position: float, speed: float) -> float:
        load[0] += -0.002 * load[0] + 0.0004 * rng.normal()
        return load[0]

    monkeypatch.setattr("greybox_torch.diagnosis.selection.search", nothing_found)
    verdict = diagnose(motor_data(torque=torque, noise=0.01), motor).verdict
    assert not verdict.mismatch and verdict.effects == ()
    assert verdict.confidence < 0.8 and verdict.left is not None and verdict.left.times_noise > 3.0
    assert any("disturbance that nobody measured" in line for line in verdict.evidence)
