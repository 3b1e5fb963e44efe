"""Where positions that no sensor shows begin."""

from __future__ import annotations

from collections.abc import Mapping

Places = Mapping[str, Mapping[str, float]]
"""By experiment and state, the positions, in their units."""

NOWHERE: Places = {}
