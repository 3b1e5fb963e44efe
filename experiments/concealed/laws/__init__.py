"""Physical laws that can be concealed in the plant, by the place where they act."""

from __future__ import annotations

from experiments.concealed.laws.base import Instant, Law, Motion

__all__ = ["Instant", "Law", "Motion"]
