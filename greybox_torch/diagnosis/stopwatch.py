"""How long the stages of a diagnosis take."""

from __future__ import annotations

import time
from dataclasses import dataclass, field


@dataclass
class Stopwatch:
    """Seconds by stage; a stage ends where :meth:`lap` is called, and the next one begins there."""

    began: float = field(default_factory=time.perf_counter)
    stages: dict[str, float] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Since it was started."""
        return time.perf_counter() - self.began

    def lap(self, stage: str) -> None:
        """Count the time since the last lap to a stage, which may be one that was there before."""
        self.stages[stage] = self.stages.get(stage, 0.0) + self.seconds - sum(self.stages.values())
