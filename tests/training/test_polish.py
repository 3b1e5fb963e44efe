"""Which penalty the held-out stretches choose."""

from __future__ import annotations

import pytest

from greybox_torch.training.polish import Choice, plainest


@pytest.mark.parametrize(
    ("errors", "chosen"),
    [
        ({None: 1.0, 10.0: 0.99, 100.0: 0.995}, None),  # a gain of one per cent is none
        ({None: 1.0, 10.0: 0.5, 100.0: 0.505, 1000.0: 0.6}, 100.0),
        ({None: 1.0, 10.0: 0.5, 100.0: 0.9}, 10.0),
        ({None: 1.0, 10.0: float("inf")}, None),
        ({None: float("inf"), 10.0: 3.0}, 10.0),
    ],
)
def test_the_plainest_that_is_about_as_good(errors: dict[float | None, float], chosen: float | None) -> None:
    assert plainest([Choice(weight, error) for weight, error in errors.items()]).weight == chosen
