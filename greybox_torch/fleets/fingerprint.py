"""What a verdict depends on, as one hash: a data set whose hash is the stored one need not be diagnosed again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

from greybox_torch import __version__
from greybox_torch.data.card import Card
from greybox_torch.fleets.job import Job
from greybox_torch.reading import opened

_PIECE = 2**20


def fingerprint(job: Job, card: Card) -> str:
    """SHA-256 of the version of this package, the fleet's choices, the card, and the content of every file that it names.

    These are the recordings and the model's file. Where a file lies and when it was written does not count.

    Raises:
        UserError: a file cannot be read.
    """
    choices = job.choices
    told = {
        "version": __version__,
        "model": None if choices.model is None else Path(choices.model).name,
        "settings": dict(choices.settings),
        "time_limit": choices.time_limit,
        "seed": choices.seed,
        "device": choices.device,
    }
    whole = hashlib.sha256(json.dumps(told, sort_keys=True, default=str).encode())
    for path in _files(job, card):
        whole.update(f"\0{path.name}\0".encode())
        whole.update(_of_file(path))
    return whole.hexdigest()


def _files(job: Job, card: Card) -> Iterator[Path]:
    yield job.card
    for file in dict.fromkeys(file for experiment in card.experiment for file in experiment.file):
        yield job.card.parent / file
    model = job.choices.model or card.model.name or ""
    file = model.rpartition(":")[0]
    if file.endswith(".py"):
        yield job.card.parent / file  # an absolute path stays what it is


def _of_file(path: Path) -> bytes:
    hashed = hashlib.sha256()
    with opened(path, "a file that the data card names") as file:
        while piece := file.read(_PIECE):
            hashed.update(piece)
    return hashed.digest()
