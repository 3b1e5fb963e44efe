"""A training as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from greybox_torch.api.fit_json import initial_json, parameters_json, status
from greybox_torch.api.scores import Scores, scores_side_by_side
from greybox_torch.api.train_explained import explanation_json
from greybox_torch.data import DataSet
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import model_reference
from greybox_torch.training import Explanation, Trained
from greybox_torch.training.polish import Choice


def training_json(
    data: DataSet, model: GreyBoxModel, found: Trained, scores: Scores, explained: Explanation | None
) -> dict[str, Any]:
    """What `greybox train` writes to train.json and prints with --json, but for where the checkpoint is."""
    problem, network = found.result.problem, found.hybrid.network
    explanation = {} if explained is None else {"explanation": explanation_json(found, explained, scores)}
    return {
        "schema": "greybox-train/1",
        "seconds": found.seconds,
        "parameters": parameters_json(found.result),
        "initial": {name: initial_json(found.result, e) for e, name in enumerate(problem.records.names)},
        "fit": scores_side_by_side(scores),
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
        "dataset": data.name,
        "model": model_reference(model),
        "held_out_by_default": data.held_out_by_default,
    }


def _choice_json(choice: Choice) -> dict[str, Any]:
    """What the held-out stretches said of a penalty; null stands for the physics alone."""
    return {"penalty": choice.weight, "mse": choice.held_out}
