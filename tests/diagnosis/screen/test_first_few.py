"""Which hypotheses a screen passes on."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.first_few import first_few
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Probe

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


@pytest.mark.parametrize(("share", "passed_on"), [(0.9, True), (0.82, True), (0.78, False)])
def test_the_first_law_at_another_kind_of_place_is_passed_on_where_it_explains_about_as_much(
    motor, stub, share, passed_on
) -> None:
    """Seen: a speed sensor's offset, behind seven constant forces that act nearly like it; in its trial it went five times as far."""

    def score(port: str, name: str, explained: float) -> ScreenScore:
        return ScreenScore(attach(motor, port, LIBRARY[name]()), Probe(("bias",)), 31, explained, np.ones(1))

    bodies = [score("rotor", "constant_bias", 0.4 - 0.001 * k) for k in range(6)]
    offset, gain = score("sensor", "sensor_bias", share * 0.4), score("sensor", "sensor_gain", share * 0.39)
    problem = stub(model=motor)
    study = stub(settings=SETTINGS, budget=BUDGET, problem=problem)
    kept = first_few(study, [*bodies, offset, gain])
    assert kept[: len(bodies)] == bodies, "ties go first"
    assert (offset in kept) is passed_on
    assert gain not in kept, "one of each kind"


def test_a_delay_of_the_output_is_passed_on_with_one_of_the_input(motor, stub) -> None:
    """Seen: a servo's command that is late, which the screen saw less of than of its sensor's lag, its friction and offsets."""

    def score(port: str, name: str, explained: float) -> ScreenScore:
        return ScreenScore(attach(motor, port, LIBRARY[name]()), Probe(("T",)), 31, explained, np.ones(1))

    first = [score("sensor", "output_delay", 0.4), *(score("rotor", "constant_bias", 0.3) for _ in range(8))]
    late, lag = score("actuator", "input_delay", 0.02), score("actuator", "input_lag", 0.02)
    kept = first_few(stub(settings=SETTINGS, budget=BUDGET, problem=stub(model=motor)), [*first, late, lag])
    assert late in kept and lag not in kept
