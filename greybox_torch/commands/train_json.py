"""What `greybox train` writes to train.json and prints with --json."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from greybox_torch.api.fit_json import initial_json, parameters_json, status
from greybox_torch.api.scores import Scores, scores_side_by_side
from greybox_torch.commands.task import Task
from greybox_torch.commands.train_explained import explanation_json
from greybox_torch.systems import model_reference
from greybox_torch.train import Explanation, Trained
from greybox_torch.train.polish import Choice

MODELS = ("start", "refit", "augmented")
"""As in `verdict.json`: the card's values, the physics alone, and the hybrid; `named` is the law that replaces the network, if one does."""


def result_json(task: Task, found: Trained, scores: Scores, explained: Explanation | None = None) -> dict[str, Any]:
    """The result as `train --json` prints it."""
    problem, network = found.result.problem, found.hybrid.network
    explanation = {} if explained is None else {"explanation": explanation_json(found, explained)}
    return {
        "schema": "greybox-train/1",
        "seconds": found.seconds,
        "parameters": parameters_json(found.result),
        "initial": {name: initial_json(found.result, e) for e, name in enumerate(problem.records.names)},
        "fit": scores_side_by_side({name: scores[name] for name in (*MODELS, "named") if name in scores}),
        "statistics": {
            "mse": found.result.mse,
            "mse_physics": found.physics.mse,
            "samples": found.result.samples,
            "epochs": len(found.history),
            "iterations": found.result.iterations,
            "status": "physics" if found.physics_chosen else status(found.result.termination),
            "held_out": [_choice_json(choice) for choice in found.polished.choices],
            "penalty": found.polished.chosen.weight,
        },
        **explanation,
        "network": {"port": network.port, "mechanism": network.mechanism.name, **network.mechanism.options()},
        "settings": found.settings.as_json(),
        "history": [asdict(epoch) for epoch in found.history],
        "dataset": task.data.name,
        "model": model_reference(task.model),
        "held_out_by_default": task.data.held_out_by_default,
        "checkpoint": str(task.folder / "model"),
    }


def _choice_json(choice: Choice) -> dict[str, Any]:
    """What the held-out stretches said of a penalty; null stands for the physics alone."""
    return {"penalty": choice.weight, "mse": choice.held_out}
