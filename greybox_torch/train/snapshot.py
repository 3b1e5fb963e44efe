"""A training on disk: one safetensors file with the arrays, and the rest as JSON in its header.

One file, so that a kill at any moment leaves the one before or this one whole. Nothing in it is executed on loading.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from greybox_torch.errors import UserError
from greybox_torch.files import write_all
from greybox_torch.train.physics import Physics
from greybox_torch.train.state import Epoch, TrainingState

SCHEMA = "greybox-training/1"
ARRAYS = ("z", "best", "first", "second", "starts")
NUMBERS = ("stage", "epoch", "best_loss", "waited", "steps", "caution")


@dataclass(frozen=True)
class Snapshot:
    """``about`` says which training it is (data, model, network, settings); ``state`` where that stands; ``physics`` what the physics
    alone was estimated at, ``scale`` (d,) and ``mean_square`` what the unknowns are measured by.
    """

    about: Mapping[str, Any]
    state: TrainingState
    physics: Physics
    scale: np.ndarray
    mean_square: float


def save_snapshot(path: Path, snapshot: Snapshot) -> None:
    """Write ``snapshot`` to ``path``, whole or not at all. Raises UserError where it cannot be written."""
    state = snapshot.state
    arrays = {name: np.ascontiguousarray(getattr(state, name)) for name in ARRAYS}
    arrays |= {"scale": snapshot.scale, **_physics_arrays(snapshot.physics)}
    content = {
        "about": dict(snapshot.about),
        "numbers": {name: getattr(state, name) for name in NUMBERS},
        "generator": state.generator,
        "history": [asdict(epoch) for epoch in state.history],
        "mean_square": snapshot.mean_square,
    }
    write_all({path: save(arrays, {"schema": SCHEMA, "training": json.dumps(content)})})


def check_snapshot(path: Path, about: Mapping[str, Any]) -> None:
    """Raises UserError unless the file at ``path`` is a snapshot of the training ``about``."""
    _read(path, about)


def load_snapshot(path: Path, about: Mapping[str, Any], physics: Physics) -> Snapshot:
    """The snapshot at ``path``, if it is of the training ``about``.

    Args:
        physics: as estimated now; the snapshot has it with the numbers as they were then.

    Raises:
        UserError: no such file, a damaged one, or one of another training.
    """
    arrays, content = _read(path, about)
    try:
        history = [Epoch(**entry) for entry in content["history"]]
        own: dict[str, Any] = {**content["numbers"], **{name: arrays[name] for name in ARRAYS}}
        state = TrainingState(generator=content["generator"], history=history, **own)
        then = _with_arrays(physics, arrays)
        return Snapshot(about, state, then, arrays["scale"], float(content["mean_square"]))
    except (KeyError, TypeError, ValueError) as error:
        raise _damaged(path, error) from None


def _read(path: Path, about: Mapping[str, Any]) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    if not path.is_file():
        raise UserError(f"--resume: {path}: no such file; expected what an interrupted training has left there")
    try:
        with safe_open(path, framework="np") as file:
            header = file.metadata() or {}
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (it is not a mapping)
        schema = header.get("schema")
        if schema != SCHEMA:
            raise UserError(f'--resume: {path}: schema is {json.dumps(schema)}, expected "{SCHEMA}"')
        content = json.loads(header["training"])
        _check_same(path, content["about"], about)
    except (SafetensorError, json.JSONDecodeError, KeyError, TypeError, ValueError) as error:
        raise _damaged(path, error) from None
    return arrays, content


def _damaged(path: Path, error: Exception) -> UserError:
    return UserError(f"--resume: {path}: damaged ({type(error).__name__}: {error}); train without --resume")


def _physics_arrays(physics: Physics) -> dict[str, np.ndarray]:
    problem = physics.result.problem
    initial = np.ascontiguousarray(problem.initial)
    return {"physics": problem.values, "initial": initial, "short": np.ascontiguousarray(physics.values)}


def _with_arrays(physics: Physics, arrays: Mapping[str, np.ndarray]) -> Physics:
    problem = physics.result.problem.with_values(arrays["physics"], arrays["initial"])
    return Physics(replace(physics.result, problem=problem), arrays["short"])


def _check_same(path: Path, found: Mapping[str, Any], expected: Mapping[str, Any]) -> None:
    """Raises UserError at the first thing in which the training that was interrupted is another."""
    wanted = json.loads(json.dumps(dict(expected)))
    for name in sorted({*found, *wanted}):
        if found.get(name) != wanted.get(name):
            raise UserError(
                f"--resume: {path}: its {name} is {json.dumps(found.get(name))}, and now it is {json.dumps(wanted.get(name))}; "
                "expected the training that was interrupted, with the same data, model and options"
            )
