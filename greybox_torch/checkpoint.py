"""Checkpoints: a model's parameter values on disk, as `NAME.safetensors` with the card `NAME.json` beside it.

The numbers are in the tensors (one float64 scalar per parameter, in its unit, under its name); the card says what they belong to.
Nothing in either file is executed on loading.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from greybox_torch import __version__
from greybox_torch.checkpoint_card import SCHEMA, CheckpointCard, read_checkpoint_card
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.files import absolute, json_text, write_all
from greybox_torch.reading import read_bytes
from greybox_torch.result_names import MODEL

_SUFFIXES = (".safetensors", ".json")


@dataclass(frozen=True)
class Checkpoint:
    """What a checkpoint holds.

    ``model`` is how to load the model (a built-in name, or "file.py:Class"), ``title`` its name for reports; ``values`` and ``units``
    are by parameter name, in declared order, values in those units. ``effects`` describe what is attached to its ports ([] for a
    plain model). ``free_starts`` says that every start state was estimated, whatever the model holds fixed. ``dataset`` is the
    SHA-256 of the samples that the values were estimated from, ``figures`` what was reached on them; ``own_starts`` is
    the model there whose free runs of estimation experiments begin with start states of the estimate, "" for none. ``own_weights`` is the
    SHA-256 of weights that the model has beside its parameters, which are not in the checkpoint; "" of a model without any.
    """

    model: str
    title: str
    values: Mapping[str, float]
    units: Mapping[str, str]
    effects: Sequence[Mapping[str, Any]] = ()
    free_starts: bool = False
    own_weights: str = ""
    dataset: str = ""
    figures: Sequence[Mapping[str, Any]] = ()
    own_starts: str = ""
    versions: Mapping[str, str] = field(default_factory=lambda: _versions())
    created: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))


def save_checkpoint(stem: Path, checkpoint: Checkpoint) -> tuple[Path, Path]:
    """Writes `stem`.safetensors and `stem`.json, and returns their paths.

    Raises UserError where they cannot be written, NumericalError where a value is not a finite number.
    """
    write_all(checkpoint_files(stem, checkpoint))
    return _halves(stem)


def checkpoint_files(stem: Path, checkpoint: Checkpoint) -> dict[Path, str | bytes]:
    """The contents of `stem`.safetensors and `stem`.json, to be written together, perhaps with other results.

    The card carries the hash of the tensors, so that halves of different checkpoints are noticed.

    What could not be loaded is not written: raises NumericalError where a value is not a finite number, UserError where a value has no
    unit or a unit no value.
    """
    tensors, card = _halves(stem)
    lacking, extra = _apart(checkpoint.values, checkpoint.units)
    if lacking or extra:
        raise UserError(f"checkpoint {card}: units: {_differences(lacking, extra)}; expected one for every value")
    for name, value in checkpoint.values.items():
        if not np.isfinite(value):
            raise NumericalError(
                f"checkpoint {tensors}: parameter {name} is {value}, not a finite number; nothing is written"
            )
    packed = save({name: np.asarray(value, dtype=np.float64) for name, value in checkpoint.values.items()})
    content = asdict(checkpoint)
    del content["values"]
    for name in ("own_weights", "own_starts"):
        if not content[name]:
            del content[name]
    content |= {"schema": SCHEMA, "parameters": list(checkpoint.values), "tensors": hashlib.sha256(packed).hexdigest()}
    return {tensors: packed, card: json_text(content)}


def load_checkpoint(path: str | PathLike[str]) -> Checkpoint:
    """The checkpoint at `path`: either of its two files, what their names have in common, or the folder of results that it is in.

    Raises:
        UserError: a file is missing or damaged, the two do not belong together, a newer version has written them, the card lacks a
            field, there are tensors too many or too few, or a value is not a finite number.
    """
    path = _found(Path(path))
    tensors, card = _halves(path)
    lacking = [half for half in (tensors, card) if not _is_there(half)]
    if len(lacking) == 2 or (lacking and _beside_results(path)):
        expected = f"expected a folder of results, or a checkpoint's two files {tensors.name} and {card.name}"
        raise UserError(f"checkpoint {path}: {_instead(path)}; {expected}")
    if lacking:
        other = card if lacking == [tensors] else tensors
        raise UserError(
            f"checkpoint {lacking[0]}: no such file (its other half {other} is there); expected {tensors.name} and {card.name}"
        )
    content = read_checkpoint_card(card)
    return Checkpoint(
        values=_values(tensors, card, content),
        **{name: getattr(content, name) for name in CheckpointCard.model_fields if name not in _OF_THE_FILES},
    )


_OF_THE_FILES = ("parameters", "tensors")
"""Fields of the card that hold the two files together and say nothing of the model."""


def _values(tensors: Path, card: Path, content: CheckpointCard) -> dict[str, float]:
    """The values that the tensors hold, in the card's order."""
    packed = read_bytes(tensors, "its tensors", "checkpoint", most=2**30)
    found = hashlib.sha256(packed).hexdigest()
    if found != content.tensors:
        raise UserError(
            f"checkpoint {tensors}: damaged, or not the file that {card.name} was written with: its SHA-256 is {found[:12]}…, "
            f'expected {content.tensors[:12]}… as "tensors" in {card.name} says'
        )
    try:
        held = load(packed)
    except (SafetensorError, KeyError, TypeError, ValueError) as error:  # all but the first: numbers that NumPy lacks
        raise UserError(f"checkpoint {tensors}: not a safetensors file of 64-bit numbers: {error}") from None
    lacking, extra = _apart(content.parameters, held)
    if lacking or extra:
        raise UserError(
            f'checkpoint {tensors}: {_differences(lacking, extra)}; expected the tensors under "parameters" in {card.name}'
        )
    return {name: _number(tensors, name, held[name]) for name in content.parameters}


def _number(tensors: Path, name: str, held: np.ndarray) -> float:
    if held.shape != () or held.dtype != np.float64:
        raise UserError(
            f"checkpoint {tensors}, tensor {name}: found {held.dtype} of shape {list(held.shape)}, expected one float64 number"
        )
    if not np.isfinite(held):
        raise UserError(f"checkpoint {tensors}, tensor {name}: found {held}, expected a finite number")
    return float(held)


def _is_there(half: Path) -> bool:
    """Whether there is anything at all; a name that no file can have has nothing."""
    try:
        return half.exists()
    except (OSError, ValueError):
        return False


def _instead(path: Path) -> str:
    """What is at `path` in the place of a checkpoint, for a message."""
    if not _is_there(path):
        return "no such file or folder"
    if path.suffix == ".toml":
        return "is a data card, no checkpoint"
    if path.is_dir():
        return "is a folder without results (model.json)"
    if _beside_results(path):
        return f"is none, the folder {path.parent} has results: name the folder"
    return "is no checkpoint"


def _beside_results(path: Path) -> bool:
    """Whether `path` is another file of a folder of results, not their checkpoint."""
    return _is_there(path) and path.name != f"{MODEL}.json" and _is_there(path.with_name(f"{MODEL}.json"))


def _found(path: Path) -> Path:
    """`path`, or the checkpoint `model` in it where it is a folder of results and not a checkpoint's name itself."""
    inside, itself = _halves(path / MODEL), _halves(path) if path.name not in ("", "..") else ()
    return path / MODEL if any(map(_is_there, inside)) and not any(map(_is_there, itself)) else path


def checkpoint_name(path: Path) -> str:
    """What the checkpoint at `path` is called: the file name without what tells its two halves apart, or the folder's name."""
    return _halves(path if path.name not in ("", "..") else absolute(path))[0].stem


def check_same_parameters(path: Path, checkpoint: Checkpoint, title: str, names: Sequence[str]) -> None:
    """Raises UserError unless the checkpoint at `path` holds the parameters `names` of the model called `title`."""
    lacking, extra = _apart(names, checkpoint.values)
    if lacking or extra:
        raise UserError(
            f"checkpoint {path}: holds the parameters of model {checkpoint.title}, which are not those of {title}: "
            + _differences(lacking, extra)
        )


def check_same_weights(path: Path, checkpoint: Checkpoint, title: str, weights: str) -> None:
    """Raises UserError where the model has other weights of its own than that whose values the checkpoint holds; it does not hold them."""
    if checkpoint.own_weights and checkpoint.own_weights != weights:
        raise UserError(
            f"checkpoint {path}: its values belong to other weights of its own than model {title} has (a network in its equations); they "
            "are not in the checkpoint: save them with torch.save(model.state_dict(), …), and load them into the model first "
            "(load_state_dict), in its __init__ for the command line"
        )


def check_same_units(path: Path, checkpoint: Checkpoint, title: str, units: Mapping[str, str]) -> None:
    """Raises UserError where a parameter of `units` is in another unit in the checkpoint: a value in rev/min is none in rad/s."""
    for name, unit in units.items():
        found = checkpoint.units.get(name)
        if found != unit:
            raise UserError(
                f'checkpoint {path}, "units": {name} is in "{found}", expected "{unit}" as model {title} has it; '
                "the model has changed since the checkpoint was written"
            )


def _apart(expected: Iterable[str], found: Iterable[str]) -> tuple[list[str], list[str]]:
    """What is lacking in `found`, and what it has beside the names expected."""
    wanted, held = dict.fromkeys(expected), dict.fromkeys(found)
    return [name for name in wanted if name not in held], [name for name in held if name not in wanted]


def _differences(lacking: Sequence[str], extra: Sequence[str]) -> str:
    return "; ".join(f"it {what} {', '.join(names)}" for what, names in (("lacks", lacking), ("has", extra)) if names)


def _halves(path: Path) -> tuple[Path, Path]:
    if path.name in ("", ".."):
        raise UserError(f'checkpoint "{path}": not the name of a file; expected one such as results/model')
    stem = path.with_suffix("") if path.suffix in _SUFFIXES else path
    return stem.with_name(stem.name + _SUFFIXES[0]), stem.with_name(stem.name + _SUFFIXES[1])


def _versions() -> dict[str, str]:
    return {"greybox_torch": __version__, "torch": version("torch")}
