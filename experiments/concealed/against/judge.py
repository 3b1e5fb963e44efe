"""What a model is worth on the held-out experiments, in the form of a verdict, so that one scoring serves the tool and its rivals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from experiments.concealed.against.plain import Plain
from greybox_torch import GreyBoxModel
from greybox_torch.estimate import problem_for

SCHEMA = "greybox-against/1"


@dataclass(frozen=True)
class Answer:
    """What a rival says of a case: its model with parameter ``values`` by name, and what it names (port, mechanism).

    ``names`` is None for a method that cannot name anything; ``notes`` is kept beside the result, for people.
    """

    model: GreyBoxModel
    values: Mapping[str, float]
    names: Sequence[tuple[str, str]] | None
    notes: Mapping[str, Any] = field(default_factory=dict)


def result(plain: Plain, baseline: str, answer: Answer, seconds: float) -> dict[str, Any]:
    """The answer judged, as it goes into a file: effects with probability one, as a rival states none, and rows as in a verdict.

    Only the held-out experiments have rows; a free run that overflows has an infinite error.
    """
    augmented = problem_for(plain.judged, answer.model, dict(answer.values))
    same = answer.model is plain.problem.model and np.array_equal(augmented.values, plain.judged.values)
    stages = {**plain.scores, "augmented": plain.scores["refit"] if same else plain.free_run(augmented)}
    return {
        "schema": SCHEMA,
        "baseline": baseline,
        "dataset": plain.data.name,
        "model": plain.problem.model.title,
        "seconds": seconds,
        "can_name": answer.names is not None,
        "mismatch": bool(answer.names),
        "effects": [{"port": port, "mechanism": name, "probability": 1.0} for port, name in answer.names or ()],
        "fit": [
            {
                "experiment": scores[0].experiment,
                "role": scores[0].role,
                "output": scores[0].output,
                **{name: {"fit": s.fit, "rmse": s.rmse} for name, s in zip(stages, scores, strict=True)},
            }
            for scores in zip(*stages.values(), strict=True)
        ],
        "notes": dict(answer.notes),
    }
