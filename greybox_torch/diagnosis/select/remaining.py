"""How much of the plain model's mismatch is left, and what may then still be taken.

No law is exactly the machine's, and sensors are good: what the right law lacks stands far above the noise, and is small beside what it
removes. Some other law will always take up part of that. So where little of the mismatch is left, a further effect is taken only if
nothing but noise remains with it: then it completes the model.
"""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.settings import DiagnosisSettings


def remaining_share(plain: Hypothesis, fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """The share of the plain model's squared error beyond the noise that ``fitted`` leaves: the largest over the window lengths."""
    shares = []
    for before, after in zip(plain.fits, fitted.fits, strict=True):
        floor = noise_floor(after.problem, settings)
        whole = before.mean_square - floor
        shares.append(max(after.mean_square - floor, 0.0) / whole if whole > 0 else 1.0)
    return max(shares, default=1.0)


def completes(fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a hypothesis leaves hardly more than noise at every window length (an upper bound, where part of the floor is motion)."""
    most = settings.above_noise**2
    return all(fit.mean_square < most * noise_floor(fit.problem, settings) for fit in fitted.fits)


def difference(plain: Hypothesis, simpler: Hypothesis, better: Hypothesis, settings: DiagnosisSettings) -> float:
    """By which share of the plain model's mismatch two hypotheses differ: the mean over the window lengths."""
    triples = zip(plain.fits, simpler.fits, better.fits, strict=True)
    return float(
        np.mean(
            [
                (s.mean_square - b.mean_square) / max(p.mean_square - noise_floor(p.problem, settings), 1e-300)
                for p, s, b in triples
            ]
        )
    )
