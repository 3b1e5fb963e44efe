"""What every command that simulates starts from: the data set, the model, and a place for results."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import torch
from rich.console import Console
from rich.text import Text

from greybox_torch.api.arguments import check_precision, named_model
from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.api.plain_arguments import check_device
from greybox_torch.api.simulate import START
from greybox_torch.checkpoint import checkpoint_name
from greybox_torch.commands.options import Options
from greybox_torch.commands.results_folder import Replacing, check_folder, others_model
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.estimate.problem import make_problem
from greybox_torch.model import GreyBoxModel
from greybox_torch.restored import load_beside


@dataclass(frozen=True)
class Task:
    """``folder`` is where results go, ``replacing`` warns of the model there that they replace."""

    data: DataSet
    model: GreyBoxModel
    device: str
    folder: Path
    precision: str = "double"
    replacing: Replacing = field(default_factory=Replacing)


def load_task(dataset: Path, options: Options, *, writes_model: str = "") -> Task:
    """Reads and checks all that the user has given, before anything is computed.

    Args:
        writes_model: the name of a command that writes a model; its task warns of a model that it replaces.

    Raises:
        UserError: the data set, the model, the device, the precision or the folder for results is not usable, or data set and model do
            not fit.
    """
    device, precision = check_device(options.device), check_precision(options.precision)
    folder = options.folder(dataset)
    check_folder(folder)
    data = load_dataset(dataset)
    torch.manual_seed(options.seed)
    model = named_model(dataset, data, options.model)
    make_problem(data, model, data.recordings)  # card and model fit together, whatever the command then takes of it
    log = Console(stderr=True, highlight=False)
    for found in data_warnings(data, model):
        log.print(Text(f"warning: {dataset}: {found}", style="yellow"), soft_wrap=True)
    replacing = Replacing(partial(others_model, folder, writes_model)) if writes_model else Replacing()
    return Task(data, model, device, folder, precision, replacing)


def simulated_by(task: Task, checkpoint: Path | None) -> tuple[GreyBoxModel, DataSet, str]:
    """What simulates: the card's model with its start values, or that of a checkpoint; the data set for it, and its name."""
    if checkpoint is None:
        return task.model, task.data, START
    return *load_beside(checkpoint, task.model, task.data), checkpoint_name(checkpoint)
