"""Units that data loggers write."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.data.units import conversion, slip

TURNS = 2 * np.pi / 60


@pytest.mark.parametrize("written", ["1/min", "U/min", "r/min", "min^-1", "min-1", "min⁻¹", "[1/min]", "rpm"])
def test_turns_per_minute(written: str) -> None:
    assert conversion(written, "rad/s", "")[0] == pytest.approx(TURNS)
    assert slip(written, "rad/s") == pytest.approx(TURNS)
    assert conversion("deg/s", written, "")[0] == pytest.approx(1 / 6)


def test_a_rate_that_is_not_of_turns() -> None:
    assert conversion("1/min", "1/s", "")[0] == pytest.approx(1 / 60)
    assert conversion("1/min", "1/h", "")[0] == pytest.approx(60)
