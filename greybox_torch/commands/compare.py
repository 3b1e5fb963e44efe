"""`greybox compare`: simulated against measured, for the start values and any number of checkpoints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from greybox_torch.api.compare import compare
from greybox_torch.api.simulate import START
from greybox_torch.checkpoint import checkpoint_name
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task


def run(dataset: Path, checkpoints: Sequence[Path], options: Options) -> None:
    """Compares the model with its start values and every checkpoint; writes a figure of each experiment."""
    task = load_task(dataset, options)
    models = {START: task.model, **dict(zip(_names(checkpoints), checkpoints, strict=True))}
    options.finish(compare(task.data, models, device=task.device, precision=task.precision), task.folder)


def _names(checkpoints: Sequence[Path]) -> list[str]:
    """The checkpoints' file names; the whole path where that alone would not tell them apart, numbered where it is given twice."""
    names: list[str] = []
    stems = [START, *[checkpoint_name(path) for path in checkpoints]]
    for path, stem in zip(checkpoints, stems[1:], strict=True):
        name = stem if stems.count(stem) == 1 else str(path)
        again = sum(other == name or other.startswith(f"{name} (") for other in names)
        names.append(f"{name} ({again + 1})" if again else name)
    return names
