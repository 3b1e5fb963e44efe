"""Whether free runs on the held-out stretches say anything of what a network has learned."""

from __future__ import annotations

import numpy as np

from greybox_torch.training import Trained

RUNS_AWAY = 100.0
"""Times the mean squared error of a constant from which a free run shows no more than that the model ran away."""


def mostly_lost(found: Trained) -> bool:
    """Whether most of the free runs on the held-out stretches, that of the physics alone among them, ran away."""
    lost = lost_choices(found)
    alone = any(one for one, choice in zip(lost, found.polished.choices, strict=True) if choice.weight is None)
    return alone and 2 * sum(lost) > len(lost)


def lost_choices(found: Trained) -> list[bool]:
    """Of every choice whether its free run on the held-out stretches ran away."""
    problem = found.result.problem
    constant = float(np.mean(np.nanvar(problem.records.y * problem.weights[:, None], axis=1)))
    return [not choice.held_out < RUNS_AWAY * constant for choice in found.polished.choices]
