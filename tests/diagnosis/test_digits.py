"""Numbers in sentences have no power of ten where a reader can do without."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.digits import digits


@pytest.mark.parametrize(
    ("value", "count", "shown"),
    [
        (338.2, 2, "340"), (38123.0, 3, "38100"), (0.5149, 2, "0.51"), (2.04, 2, "2"), (99.6, 2, "100"), (0.00123, 2, "0.0012"),
        (3.21e7, 2, "3.2e+07"), (4.4e-6, 2, "4.4e-06"), (0.0, 2, "0"), (float("inf"), 2, "inf"),
    ],
)  # fmt: skip
def test_digits(value: float, count: int, shown: str) -> None:
    assert digits(value, count) == shown
