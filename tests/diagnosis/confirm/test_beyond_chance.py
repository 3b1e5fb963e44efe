"""How sure a finding is by what held-out experiments show of it."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.beyond_chance import part_borne_out, within_chance
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.describe.effects import describe
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.select.all_that_is_left import LeftInFreeRuns
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction

from ..conftest import found

SETTINGS = DiagnosisSettings()


@pytest.mark.parametrize(
    ("gain", "part"),
    [
        (Gain(0.175, 0.138), 0.55),
        (Gain(0.0, 0.1), 0.5),
        (Gain(0.9, 0.1), 1.0),
        (Gain(0.0005, 0.0005), 1.0),
        (Gain(0.3, 0.2, untouched=True), 1.0),
        (Gain(0.3, np.inf), 1.0),
        (None, 1.0),
    ],
    ids=[
        "a servo's curve",
        "nothing shown",
        "beyond chance",
        "not exercised",
        "untouched",
        "too few windows",
        "no others",
    ],
)
def test_within_chance_that_nothing_is_there_is_a_rival(gain: Gain | None, part: float) -> None:
    """Seen: a curve at a servo's joint, told with 0.96 beside an interval of what it removes of -9.5 to 44.5 %."""
    assert part_borne_out(gain, SETTINGS) == pytest.approx(part, abs=0.005)
    assert within_chance(gain, SETTINGS) is (part < 1.0)


def test_a_finding_and_its_statement_are_no_surer_than_held_out_experiments_are(motor_data, motor, begun) -> None:
    search = begun(motor_data(torque=lambda q, v: -0.05 * np.tanh(v / 0.05), noise=0.002), motor)
    effect = attach(motor, "rotor", CoulombFriction())
    state = found(search, effect, {f"{effect.prefix}.F_c": 0.05})
    final, told = finish(state.current), []
    for gain in (Gain(0.9, 0.1), Gain(0.175, 0.138)):
        (one,) = describe(
            search.study, state, final, LeftInFreeRuns(0.001), {effect.prefix: gain}, {effect.prefix: 0.9}, 0.9
        )
        told.append(one)
    sure, unsure = told
    assert unsure.probability == pytest.approx(
        part_borne_out(Gain(0.175, 0.138), SETTINGS) * sure.probability, abs=1e-3
    )
    assert not sure.remarks
    (remark,) = unsure.remarks
    assert (
        "held-out experiments put it 1.3 standard errors from none, where 3 standard errors are beyond chance" in remark
    )
