"""What a designed recording is expected to say in a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.experiment_design.separation import expected_probability, seconds_for

AS_IN_A_DIAGNOSIS = DiagnosisSettings()
VISIBLE = AS_IN_A_DIAGNOSIS.visible_divergence
"""Nats below which two hypotheses cannot be told apart, as in a diagnosis."""
WANTED = 0.95
NOTHING = AS_IN_A_DIAGNOSIS.least_alternative
"""Probability below which a rival is next to nothing, and a diagnosis does not list it."""

NO_MORE = 0.005
"""Difference of two probabilities that does not show in two digits."""


def decided(probabilities: Sequence[float]) -> bool:
    """Whether there is nothing left to decide: one hypothesis has what is wanted, and every other one next to nothing."""
    best, *others = sorted(probabilities, reverse=True)
    return best >= WANTED and all(p < NOTHING for p in others)


@dataclass(frozen=True)
class Expected:
    """What a recording is expected to say: probabilities ``before`` it, and the evidence ``nats`` (n, n) for each hypothesis (row, if it
    is right) against each other one. ``random_nats``: those after a random multisine of the same power.

    Hypotheses that this input does not tell apart count as one, and evidence as it counts in a diagnosis.
    """

    before: tuple[float, ...]
    nats: np.ndarray
    random_nats: np.ndarray | None

    @property
    def alike(self) -> np.ndarray:
        """Whether two hypotheses, (n, n), are not told apart."""
        return np.minimum(self.nats, self.nats.T) < VISIBLE

    @property
    def groups(self) -> list[list[int]]:
        """Indices of the hypotheses in groups, the likeliest group first: within one, each is not told from some other one of it."""
        left, found = set(range(len(self.before))), []
        while left:
            group, new = set[int](), {min(left)}
            while new:
                group |= new
                new = {b for a in new for b in left - group if self.alike[a, b]}
            left -= group
            found.append(sorted(group))
        return sorted(found, key=lambda group: -self._share(group))

    @property
    def by_groups(self) -> bool:
        """Whether what it tells apart, of what is in question, are groups of several hypotheses each that it does not."""
        asked = [[k for k in group if k in self.in_question] for group in self.groups]
        return sum(map(bool, asked)) > 1 and any(len(group) > 1 for group in asked)

    @property
    def today(self) -> float:
        """The probability of the likeliest group before the recording."""
        return min(self._share(self.groups[0]), AS_IN_A_DIAGNOSIS.highest_probability)

    @property
    def gains(self) -> bool:
        """Whether the right one is expected to be more probable than the likeliest is before the recording."""
        return self.after - self.today >= NO_MORE

    @property
    def random_does_as_well(self) -> bool:
        """Whether the random input is expected to do no worse."""
        return self.random is not None and self.after - self.random < NO_MORE

    def _share(self, group: Sequence[int]) -> float:
        return sum(self.before[k] for k in group) / sum(self.before)

    @property
    def in_question(self) -> list[int]:
        """Indices of the hypotheses that are not next to nothing; all of them where that is one alone."""
        found = [k for k, p in enumerate(self.before) if p >= NOTHING]
        return found if len(found) > 1 else list(range(len(self.before)))

    @property
    def decides(self) -> bool:
        """Whether it tells any of those in question apart: of two that a third is alike to, either may still be that one."""
        return sum(any(k in self.in_question for k in group) for group in self.groups) > 1

    @property
    def worth_recording(self) -> bool:
        """Whether more is expected to be known after it than before."""
        return self.decides and self.gains

    @property
    def after(self) -> float:
        """The expected probability of the right one."""
        return min(self._probability(self.nats), AS_IN_A_DIAGNOSIS.highest_probability)

    @property
    def random(self) -> float | None:
        """The expected probability of the right one after the random input."""
        if self.random_nats is None:
            return None
        return min(self._probability(self.random_nats), AS_IN_A_DIAGNOSIS.highest_probability)

    def seconds_for(self, wanted: float, seconds: float) -> float:
        """How long a recording like one of so many ``seconds`` must be for a ``wanted`` expected probability."""
        nats = np.where(self.alike, 0.0, self.nats)
        temperature = AS_IN_A_DIAGNOSIS.windows_temperature
        return seconds_for(self.before, nats, seconds, wanted, alike=self.alike, temperature=temperature)

    def _probability(self, nats: np.ndarray) -> float:
        temperature = AS_IN_A_DIAGNOSIS.windows_temperature
        return expected_probability(self.before, nats, alike=self.alike, temperature=temperature)
