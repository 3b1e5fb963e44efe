"""The unit of plain numbers, "1", is not printed behind them: "-0.581 < duty < 0.251 1" was seen."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.describe.where import where
from greybox_torch.diagnosis.effect import Profile
from greybox_torch.in_unit import in_unit
from greybox_torch.report import text


def test_a_number_with_its_unit() -> None:
    assert [in_unit("0.251", unit) for unit in ("rad", "1", "")] == ["0.251 rad", "0.251", "0.251"]
    assert text.with_unit("0.251", "1") == "0.251" and text.with_unit("0.251", "N m") == "0.251 N·m"
    assert text.axis("duty", "1") == "duty" and text.axis("speed", "rad/s") == "speed [rad/s]"


def test_a_range_of_a_plain_number() -> None:
    profile = Profile("duty", "1", np.linspace(-1.0, 1.0, 11), np.where(np.arange(10) == 6, 1.0, 0.0))
    assert where((profile,), ()) == "100 % of what it explains lies within 0.2 < duty < 0.4"
