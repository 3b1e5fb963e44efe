"""Numbers of tables on the console."""

from __future__ import annotations

import pytest

from greybox_torch.report.tables import number


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(10000, 4, "10000"), (123456, 4, "123456"), (10000.0, 4, "1e+04"), (0.0012345, 4, "0.001234"), (0, 5, "0")],
)
def test_a_count_is_in_full(value: float, digits: int, text: str) -> None:
    """Seen: 1e+04 samples."""
    assert number(value, digits) == text
