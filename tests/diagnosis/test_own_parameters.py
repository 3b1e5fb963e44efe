"""What a reader is told of the model's own parameters."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.own_parameters import Estimate, far_refits


@pytest.mark.parametrize(
    ("refit", "augmented", "told"),
    [
        (28600.0, (1.2e6, 430.0), True),
        (0.17e6, (1.2e6, 430.0), True),  # seen: 7 times as large in `fit`, both with a small deviation, without a word
        (0.9e6, (1.2e6, 430.0), False),
        (1.18e6, (1.2e6, 430.0), False),
        (28600.0, (29000.0, 430.0), False),
        (28600.0, None, False),
        (0.0, (1.2e6, 430.0), False),
        (-1e6, (1.2e6, 430.0), True),
    ],
)
def test_a_refit_far_off_is_told(refit: float, augmented: tuple[float, float] | None, told: bool) -> None:
    """Seen: "C_air 28600 ± 1500" where `fit` has 1.18e6 ± 0.04e6 of the same model and recordings, without a word."""
    found = far_refits([Estimate("C_air", "J/K", 1e6, (refit, 1500.0), augmented)])
    assert bool(found) is told
    if refit == 28600.0 and told:
        assert found[0].startswith("Re-estimated without the effects: C_air = 2.86e+04 J/K (1.2e+06 with them). It may")


@pytest.mark.parametrize(
    ("deviations", "at_bound"),
    [
        ((None, 430.0), (False, False)),
        ((3e6, 430.0), (False, False)),
        ((1500.0, 430.0), (True, False)),
        ((1500.0, None), (False, False)),
        ((1500.0, 3e6), (False, False)),
        ((1500.0, 430.0), (False, True)),
    ],
)
def test_an_estimate_that_is_not_determined_is_not_told(deviations, at_bound) -> None:
    """As little where it is the one with the effects: 1.2e6 ± 3e6 is not far from anything."""
    one = Estimate("b", "N s/m", 1e6, (28600.0, deviations[0]), (1.2e6, deviations[1]), at_bound)
    assert far_refits([one]) == ()
