"""Numbers in sentences: a few digits, and no power of ten where a reader can do without."""

from __future__ import annotations

import math


def digits(value: float, count: int = 2) -> str:
    """So many significant digits: 340 and not 3.4e+02; beyond a million, and below a ten-thousandth, with a power of ten.

    Examples:
        >>> digits(338.2), digits(38123.0, 3), digits(0.51), digits(2.0)
        ('340', '38100', '0.51', '2')
    """
    if not math.isfinite(value) or not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{count}g}"
    return f"{float(f'{value:.{count - 1}e}'):.10g}"
