"""Checkpoints: a model's parameter values on disk, as `NAME.safetensors` with the card `NAME.json` beside it.

The numbers are in the tensors (one float64 scalar per parameter, in its unit, under its name); the card says what they belong to.
Nothing in either file is executed on loading.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from greybox_torch.errors import UserError
from greybox_torch.files import json_text, write_all

SCHEMA = "greybox-checkpoint/1"
_SUFFIXES = (".safetensors", ".json")


@dataclass(frozen=True)
class Checkpoint:
    """What a checkpoint holds.

    ``model`` is how to load the model (a built-in name, or "file.py:Class"), ``title`` its name for reports; ``values`` and ``units``
    are by parameter name, in declared order, values in those units. ``effects`` describe what is attached to its ports ([] for a
    plain model). ``free_starts`` says that every start state was estimated, whatever the model holds fixed. ``dataset`` is the
    SHA-256 of the samples that the values were estimated from, ``figures`` what was reached on them.
    """

    model: str
    title: str
    values: Mapping[str, float]
    units: Mapping[str, str]
    effects: Sequence[Mapping[str, Any]] = ()
    free_starts: bool = False
    dataset: str = ""
    figures: Sequence[Mapping[str, Any]] = ()
    versions: Mapping[str, str] = field(default_factory=lambda: _versions())
    created: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))


def save_checkpoint(stem: Path, checkpoint: Checkpoint) -> tuple[Path, Path]:
    """Writes `stem`.safetensors and `stem`.json, and returns their paths.

    Raises UserError where they cannot be written.
    """
    write_all(checkpoint_files(stem, checkpoint))
    return _halves(stem)


def checkpoint_files(stem: Path, checkpoint: Checkpoint) -> dict[Path, str | bytes]:
    """The contents of `stem`.safetensors and `stem`.json, to be written together, perhaps with other results.

    The card carries the hash of the tensors, so that halves of different checkpoints are noticed.
    """
    tensors, card = _halves(stem)
    packed = save({name: np.asarray(value, dtype=np.float64) for name, value in checkpoint.values.items()})
    content = asdict(checkpoint)
    del content["values"]
    content |= {"schema": SCHEMA, "parameters": list(checkpoint.values), "tensors": hashlib.sha256(packed).hexdigest()}
    return {tensors: packed, card: json_text(content)}


def load_checkpoint(path: Path) -> Checkpoint:
    """The checkpoint at `path`: either of its two files, or what their names have in common.

    Raises:
        UserError: a file is missing or damaged, the two do not belong together, or a newer version has written them.
    """
    tensors, card = _halves(path)
    for half, other in ((tensors, card), (card, tensors)):
        if not half.is_file():
            what = f"its other half {other} is there" if other.is_file() else "nor is its other half"
            raise UserError(f"checkpoint {half}: no such file ({what}); expected {tensors.name} and {card.name}")
    content = _read_card(card)
    packed = tensors.read_bytes()
    if hashlib.sha256(packed).hexdigest() != content["tensors"]:
        raise UserError(f"checkpoint {tensors}: damaged, or not the file that {card.name} was written with")
    try:
        found = load(packed)
    except SafetensorError as error:
        raise UserError(f"checkpoint {tensors}: not a safetensors file: {error}") from None
    names = content["parameters"]
    if sorted(found) != sorted(names):
        raise UserError(f"checkpoint {tensors}: holds {', '.join(found)}; {card.name} says {', '.join(names)}")
    values = {name: float(found[name]) for name in names}
    own = {
        key: content[key]
        for key in ("model", "title", "units", "effects", "free_starts", "dataset", "figures", "versions", "created")
    }
    return Checkpoint(values=values, **own)


def checkpoint_name(path: Path) -> str:
    """What the checkpoint at `path` is called: the file name without what tells its two halves apart."""
    return _halves(path)[0].stem


def check_same_parameters(path: Path, checkpoint: Checkpoint, title: str, names: Sequence[str]) -> None:
    """Raises UserError unless the checkpoint at `path` holds the parameters `names` of the model called `title`."""
    missing = [name for name in names if name not in checkpoint.values]
    extra = [name for name in checkpoint.values if name not in names]
    if missing or extra:
        differences = [f"it lacks {', '.join(missing)}"] * bool(missing) + [f"it has {', '.join(extra)}"] * bool(extra)
        raise UserError(
            f"checkpoint {path}: holds the parameters of model {checkpoint.title}, which are not those of {title}: "
            + "; ".join(differences)
        )


_TYPES: dict[str, type] = {
    "model": str,
    "title": str,
    "parameters": list,
    "units": dict,
    "effects": list,
    "free_starts": bool,
    "dataset": str,
    "figures": list,
    "versions": dict,
    "created": str,
    "tensors": str,
}


def _read_card(card: Path) -> dict[str, Any]:
    try:
        content = json.loads(card.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise UserError(f"checkpoint {card}: not JSON: {error}") from None
    schema = content.get("schema") if isinstance(content, dict) else None
    if schema != SCHEMA:
        newer = re.fullmatch(r"greybox-checkpoint/([2-9]|[1-9]\d+)", str(schema)) is not None
        advice = "; a newer greybox_torch has written it: update to read it" if newer else ""
        raise UserError(f'checkpoint {card}: schema is {json.dumps(schema)}, expected "{SCHEMA}"{advice}')
    for key, kind in _TYPES.items():
        if not isinstance(content.get(key), kind):
            raise UserError(f'checkpoint {card}: "{key}" is {json.dumps(content.get(key))}, expected a {kind.__name__}')
    return content


def _halves(path: Path) -> tuple[Path, Path]:
    stem = path.with_suffix("") if path.suffix in _SUFFIXES else path
    return stem.with_name(stem.name + _SUFFIXES[0]), stem.with_name(stem.name + _SUFFIXES[1])


def _versions() -> dict[str, str]:
    def of(package: str) -> str:
        try:
            return version(package)
        except PackageNotFoundError:
            return "unknown"

    return {package: of(package) for package in ("greybox_torch", "torch")}
