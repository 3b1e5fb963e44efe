"""A training on disk: one safetensors file with the arrays, and the rest as JSON in its header.

One file, so that a kill at any moment leaves the one before or this one whole. Nothing in it is executed on loading.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from greybox_torch.errors import UserError
from greybox_torch.files import write_all
from greybox_torch.reading import check_file
from greybox_torch.training.physics import Physics
from greybox_torch.training.state import Epoch, TrainingState

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
        _check_arrays(arrays, physics)
        _check_numbers(content)
        np.random.default_rng().bit_generator.state = content["generator"]
        state = TrainingState(generator=content["generator"], history=history, **own)
        then = _with_arrays(physics, arrays)
        return Snapshot(about, state, then, arrays["scale"], float(content["mean_square"]))
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise _damaged(path, error) from None


def check_unknowns(path: Path, snapshot: Snapshot, unknowns: int, states: int) -> None:
    """Raises UserError unless the snapshot has as many unknowns as the training, and windows that start in as many states."""
    found = len(snapshot.state.z), snapshot.state.starts.shape[1]
    if found != (unknowns, states):
        raise _damaged(path, ValueError(f"{found[0]} unknowns and {found[1]} states, expected {unknowns} and {states}"))


def _read(path: Path, about: Mapping[str, Any]) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    check_file(path, "what an interrupted training has left there", "snapshot")
    try:
        with safe_open(path, framework="np") as file:
            header = file.metadata() or {}
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (it is not a mapping)
        schema = header.get("schema")
        if schema != SCHEMA:
            raise UserError(f'snapshot {path}: schema is {json.dumps(schema)}, expected "{SCHEMA}"')
        content = json.loads(header["training"])
        _check_same(path, content["about"], about)
    except (SafetensorError, KeyError, TypeError, ValueError, AttributeError, RecursionError, OSError) as error:
        raise _damaged(path, error) from None
    return arrays, content


def _damaged(path: Path, error: Exception) -> UserError:
    return UserError(f"snapshot {path}: damaged ({type(error).__name__}: {error}); train anew instead of resuming")


def _physics_arrays(physics: Physics) -> dict[str, np.ndarray]:
    problem = physics.result.problem
    initial = np.ascontiguousarray(problem.initial)
    return {"physics": problem.values, "initial": initial, "short": np.ascontiguousarray(physics.values)}


def _with_arrays(physics: Physics, arrays: Mapping[str, np.ndarray]) -> Physics:
    problem = physics.result.problem.with_values(arrays["physics"], arrays["initial"])
    return Physics(replace(physics.result, problem=problem), arrays["short"])


def _check_arrays(arrays: Mapping[str, np.ndarray], physics: Physics) -> None:
    """Raises ValueError unless the arrays are of one training: float64, finite, and as long as each other and as the physics."""
    problem = physics.result.problem
    length = arrays["z"].shape
    expected = {"physics": problem.values.shape, "initial": problem.initial.shape, "short": physics.values.shape}
    expected |= dict.fromkeys(("best", "first", "second", "scale"), length)
    for name in (*ARRAYS, "scale", "physics", "initial", "short"):
        array = arrays[name]
        if array.dtype != np.float64 or not np.isfinite(array).all():
            raise ValueError(f"{name} is not of finite 64-bit numbers")
        if array.shape != expected.get(name, array.shape) or (name == "starts" and array.ndim != 2):
            raise ValueError(f"{name} has the shape {array.shape}, expected {expected.get(name, '(windows, states)')}")
    if len(length) != 1:
        raise ValueError(f"z has the shape {length}, expected one number for each unknown")
    if (arrays["scale"] <= 0.0).any():
        raise ValueError("a scale is not above zero")


def _check_numbers(content: Mapping[str, Any]) -> None:
    numbers = content["numbers"]
    for name in ("stage", "epoch", "waited", "steps"):
        if not isinstance(numbers[name], int) or numbers[name] < 0:
            raise ValueError(f"{name} is {numbers[name]!r:.40}, expected a whole number")
    for name, value in {**numbers, "mean_square": content["mean_square"]}.items():
        if name not in NUMBERS and name != "mean_square":
            raise ValueError(f"unknown entry {name!r:.40}")
        if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value) or value < 0:
            raise ValueError(f"{name} is {value!r:.40}, expected a number that is not negative")


def _check_same(path: Path, found: Mapping[str, Any], expected: Mapping[str, Any]) -> None:
    """Raises UserError at the first thing in which the training that was interrupted is another."""
    wanted = json.loads(json.dumps(dict(expected)))
    for name in sorted({*found, *wanted}):
        if found.get(name) != wanted.get(name):
            raise UserError(
                f"snapshot {path}: its {name} is {json.dumps(found.get(name))}, and now it is {json.dumps(wanted.get(name))}; "
                "expected the training that was interrupted, with the same data, model and options"
            )
