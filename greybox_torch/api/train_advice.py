"""What the validation experiments say about a trained network."""

from __future__ import annotations

import numpy as np

from greybox_torch.api.scores import Scores
from greybox_torch.api.train_scores import HYBRID, NAMED, PHYSICS
from greybox_torch.estimate.comparison import mean_fit

WORSE = 0.01
"""Points of the mean fit in % from which a model simulates worse than another."""


def train_advice(scores: Scores) -> list[str]:
    """Sentences where the hybrid, or the model with a law in the network's place, simulates the validation experiments worse than the
    physics alone; none where there are no such experiments.
    """
    judging = {name: [s for s in own if s.role == "validation"] for name, own in scores.items()}
    if not judging[PHYSICS]:
        return []
    fits = {name: mean_fit(own) for name, own in judging.items()}
    alone = fits[PHYSICS]
    if not np.isfinite(alone):
        return []  # of runs that are lost without the network as well, this says nothing
    whose = {HYBRID: "the hybrid simulates", NAMED: "the model with the law in the network's place simulates"}
    worse = [name for name in whose if name in fits and fits[name] < alone - WORSE]
    return [f"{_told(whose[name], fits[name], alone)}{_INSTEAD}" for name in worse]


_INSTEAD = "what was learned does not carry over to them. Use the physics alone (`greybox fit`), or train on recordings like them."


def _told(who: str, fit: float, alone: float) -> str:
    found = (
        f"mean fit {fit:.4g} % for {alone:.4g} %"
        if np.isfinite(fit)
        else f"it overflows; mean fit {alone:.4g} % without"
    )
    return f"On the validation experiments {who} worse than the physics alone ({found}): "
