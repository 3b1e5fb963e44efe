"""Refitted hypotheses as candidates of a choice: how each compares with the one before it, and their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.hypothesis.degenerate import degenerate, grows_with_speed
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.in_a_few_samples import acts_in_a_few_samples
from greybox_torch.diagnosis.hypothesis.significance import over_the_same_windows, white_samples, window_significance
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study


@dataclass(frozen=True)
class RankedCandidate:
    """A refitted hypothesis with its newest effect; ``gain``: by how much its score is below that of the one before, ``significance``: by
    how many standard errors over windows.
    """

    candidate: Candidate
    fitted: Hypothesis
    gain: float
    significance: float
    cost: float | None = None
    """Negative logarithm of the likelihood of whole records, errors coloured, where others fit windows alike and noise alone is left."""
    plausible: float = 0.0
    """How much of the gain is that the model as it stands has parameters far from the card's values, where that is what came before."""

    @property
    def of_errors(self) -> float:
        """How much of the gain is that of the logarithm of the mean squared error."""
        return self.gain - self.plausible

    @property
    def removed(self) -> float:
        """The share of the mean squared error that it removes, the mean over window lengths in logarithms."""
        return 1.0 - float(np.exp(-self.of_errors))

    @property
    def unknown(self) -> bool:
        """Whether the newest effect is a free curve rather than a law."""
        return self.candidate.unknown

    @property
    def size(self) -> int:
        """How many parameters the newest effect has to adjust."""
        start = f"{self.candidate.attachment.prefix}."
        return sum(name.startswith(start) for name in self.fitted.problem.free_names)


def in_order(ranked: Sequence[RankedCandidate], settings: DiagnosisSettings) -> list[RankedCandidate]:
    """Best first: by score, with a price for every parameter: of laws that fit alike, the simpler one is meant.

    Where the best leaves white noise alone the price is log(N) / N for N samples, by which a law is likelier. Where more is left, errors
    are neither white nor only the lacking effect's, and the samples say less than their number.

    Source: G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6, 1978.
    """
    best = min((r.fitted for r in ranked), key=lambda h: h.score, default=None)
    price = settings.parameter_price
    if best is not None and white_samples(best, settings):
        price = min(price, price_of_noise(best, settings))
    return sorted(ranked, key=lambda r: r.fitted.score + price * r.size)


def price_of_noise(best: Hypothesis, settings: DiagnosisSettings) -> float:
    """By how much the score has to fall for a further parameter to be likely, where white noise alone is left: log(N) / N; else 0."""
    samples = white_samples(best, settings)
    return float(np.log(samples)) / samples if samples else 0.0


def priced_cost(ranked: RankedCandidate, samples: int) -> float:
    """The cost of a hypothesis, zero where it is not known, with a price of half of log(N) for every parameter of its law."""
    return (0.0 if ranked.cost is None else ranked.cost) + 0.5 * ranked.size * float(np.log(samples))


def judged(
    candidate: Candidate, before: Hypothesis, fitted: Hypothesis, settings: DiagnosisSettings
) -> RankedCandidate:
    """A refit compared with the hypothesis ``before`` it."""
    gain, plausible = before.score - fitted.score, before.implausible - fitted.implausible
    return RankedCandidate(candidate, fitted, gain, window_significance(before, fitted, settings), plausible=plausible)


def judged_beside(
    candidate: Candidate, step_before: Hypothesis, plain: Hypothesis, fitted: Hypothesis, settings: DiagnosisSettings
) -> RankedCandidate:
    """A refit compared with the hypothesis ``step_before`` a step or, where that step was taken with fewer experiments, with ``plain``."""
    before = step_before if over_the_same_windows(step_before, fitted) else plain
    return judged(candidate, before, fitted, settings)


def doubtful(ranked: RankedCandidate, settings: DiagnosisSettings) -> bool:
    """Whether windows leave open if it is chance, of a law that removes most of the error: for held-out experiments to decide."""
    open_still = settings.least_significance_of_doubtful < ranked.significance <= settings.least_significance
    return open_still and not ranked.unknown and ranked.removed > settings.least_share_of_doubtful


def sound(study: Study, ranked: RankedCandidate) -> bool:
    """Whether the newest effect's parameters, as they were refitted, say something of the machine."""
    effect, fitted = ranked.candidate.attachment, ranked.fitted
    says_something = degenerate(effect, study.surroundings, fitted.values()) is None
    if not says_something or grows_with_speed(fitted, effect, study.surroundings, study.settings):
        return False
    return not acts_in_a_few_samples(fitted, effect, study.settings)
