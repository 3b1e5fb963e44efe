"""What the validation experiments say about a trained network."""

from __future__ import annotations

import numpy as np

from greybox_torch.api.scores import Scores
from greybox_torch.api.train_scores import HYBRID, NAMED, PHYSICS
from greybox_torch.estimate.comparison import mean_fit
from greybox_torch.training import Explanation
from greybox_torch.training.explain import KEEP

WORSE = 0.01
"""Points of the mean fit in % from which a model simulates worse than another."""


def train_advice(scores: Scores) -> list[str]:
    """Sentences where the hybrid, or the model with a law in the network's place, simulates the validation experiments, or one output of
    them, worse than the physics alone; none where there are no such experiments.
    """
    fits = _fits(scores)
    whose = {HYBRID: "the hybrid simulates", NAMED: "the model with the law in the network's place simulates"}
    worse = [name for name in whose if _is_worse(fits, name)]
    use = _USE_LAW if NAMED in fits and NAMED not in worse else _USE_PHYSICS
    return [
        f"{_told(whose[name], fits[name], fits[PHYSICS])}what was learned does not carry over to them. {use}"
        for name in worse
    ] + [line for name in whose if name not in worse for line in _outputs_told(whose[name], scores, name)]


def _outputs_told(who: str, scores: Scores, name: str) -> list[str]:
    """A sentence for every output that a model simulates worse, though it is no worse in the mean of all."""
    if name not in scores:
        return []
    found = []
    for output in dict.fromkeys(s.output for s in scores[name]):
        fits = _fits({model: [s for s in own if s.output == output] for model, own in scores.items()})
        if _is_worse(fits, name):
            found.append(
                f"On the validation experiments {who} {output} worse than the physics alone ({_numbers(fits[name], fits[PHYSICS])}), "
                "though all outputs together no worse: where that output is what counts, use the physics alone."
            )
    return found


NOT_JUDGED = "Whether a law does what the network does is not known: most free runs on the held-out stretches ran away."


def explained_sentence(explained: Explanation, scores: Scores, *, judged: bool = True) -> str:
    """What the network stands for, without the advice to keep it where :func:`train_advice` is against that, or where the held-out
    stretches have not ``judged`` it, as most free runs there ran away: nor do these tell then which law is closest.
    """
    if not judged and explained.terms and explained.term is None:
        return NOT_JUDGED
    said = explained.sentence
    return said.removesuffix(KEEP).rstrip() if not judged or _is_worse(_fits(scores), HYBRID) else said


def _fits(scores: Scores) -> dict[str, float]:
    """The mean fits on the validation experiments by model; empty where there are none."""
    judging = {name: [s for s in own if s.role == "validation"] for name, own in scores.items()}
    return {name: mean_fit(own) for name, own in judging.items()} if judging[PHYSICS] else {}


def _is_worse(fits: dict[str, float], name: str) -> bool:
    """Whether a model simulates worse than the physics alone; where that is lost as well, the runs say nothing."""
    return name in fits and bool(np.isfinite(fits[PHYSICS])) and fits[name] < fits[PHYSICS] - WORSE


_USE_PHYSICS = "Use the physics alone (`greybox fit`), or train on recordings like them."
_USE_LAW = "Use the model with the law in the network's place (`named`)."


def _told(who: str, fit: float, alone: float) -> str:
    return f"On the validation experiments {who} worse than the physics alone ({_numbers(fit, alone)}): "


def _numbers(fit: float, alone: float) -> str:
    return (
        f"mean fit {fit:.4g} % for {alone:.4g} %"
        if np.isfinite(fit)
        else f"it overflows; mean fit {alone:.4g} % without"
    )
