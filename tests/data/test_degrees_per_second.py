"""Degrees per second as gyroscopes write them: the unit "dps" is known as the ending of a name is."""

from __future__ import annotations

import numpy as np

from greybox_torch.data.units import conversion


def test_dps() -> None:
    """Seen: file_unit = "dps" was refused, though the ending _dps was understood."""
    np.testing.assert_allclose(conversion("dps", "rad/s", ""), (np.pi / 180.0, 0.0))
    np.testing.assert_allclose(conversion("rad/s", "dps", ""), (180.0 / np.pi, 0.0))
