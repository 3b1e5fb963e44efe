"""Shares of successes with exact intervals."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.stats import beta


@dataclass(frozen=True)
class Rate:
    """`hits` of `cases`, with the Clopper-Pearson interval at the given level.

    C. J. Clopper and E. S. Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial", Biometrika 26,
    1934: never narrower than its level says.
    """

    hits: int
    cases: int
    level: float = 0.95

    @property
    def share(self) -> float:
        return self.hits / self.cases if self.cases else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper bound; (0, 1) where there is no case."""
        tail = (1.0 - self.level) / 2.0
        low = beta.ppf(tail, self.hits, self.cases - self.hits + 1) if self.hits > 0 else 0.0
        high = beta.ppf(1.0 - tail, self.hits + 1, self.cases - self.hits) if self.hits < self.cases else 1.0
        return float(low), float(high)

    def __str__(self) -> str:
        if not self.cases:
            return "none"
        low, high = self.interval
        return f"{self.hits}/{self.cases} ({100 * self.share:.0f} %, {100 * low:.0f} to {100 * high:.0f} %)"
