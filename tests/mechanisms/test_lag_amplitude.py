"""What a lag is absent without."""

from __future__ import annotations

import pytest

from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.sensor import SensorLag
from greybox_torch.mechanisms.surroundings import Surroundings


@pytest.mark.parametrize("law", [InputLag, SensorLag])
@pytest.mark.parametrize("second_order", [False, True])
def test_a_lag_whose_time_the_recordings_do_not_determine_is_none_however_sure_its_damping_is(
    law, second_order
) -> None:
    """Seen: a robot on two ramps, its friction told as a lag of 2.25 s, give or take 3.46 s, with a damping of 1.43 ± 0.37."""
    around = Surroundings({}, {}, "V", 0.01)
    lag, values = law(second_order), {"T": 2.25} | ({"damping": 1.43} if second_order else {})
    assert lag.amplitudes(around) == ("T",)
    said = lag.degenerate(around, values, {"T": 3.46} | ({"damping": 0.37} if second_order else {}))
    assert said is not None and "smaller than its standard deviation" in said
    assert lag.degenerate(around, values, dict.fromkeys(values, 0.1)) is None
