"""What every command that simulates starts from: the data set, the model, the device."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import torch

from greybox_torch.commands.options import Options
from greybox_torch.data import DataSet, Recording, load_dataset
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.estimate.precision import PRECISIONS
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import BUILT_IN, load_model


@dataclass(frozen=True)
class Task:
    """``model_name`` is how to load the model, with the file part absolute; ``folder`` is where results go."""

    data: DataSet
    model: GreyBoxModel
    model_name: str
    device: str
    folder: Path
    precision: str = "double"

    def problem(
        self, recordings: Sequence[Recording] | None = None, values: Mapping[str, float] | None = None
    ) -> Problem:
        """The model on all recordings, or on some, with the card's values or with others."""
        return make_problem(
            self.data, self.model, self.data.recordings if recordings is None else recordings, values=values
        )


def load_task(dataset: Path, options: Options) -> Task:
    """Reads and checks all that the user has given, before anything is computed.

    Raises:
        UserError: the data set, the model, the device, the precision or the folder for results is not usable, or data set and model do
            not fit.
    """
    device = check_device(options.device)
    check_precision(options.precision)
    folder = options.folder(dataset)
    check_folder(folder)
    data = load_dataset(dataset)
    name = options.model or data.model
    if name is None:
        known = ", ".join(BUILT_IN)
        raise UserError(
            f"{dataset}: [model] name is missing and no --model is given; expected a built-in system ({known}) or a file and class "
            "such as my_motor.py:Motor"
        )
    torch.manual_seed(options.seed)
    task = Task(data, load_model(name), absolute(name), device, folder, options.precision)
    task.problem()  # card and model fit together, whatever the command then takes of it
    return task


def check_estimation(dataset: Path, data: DataSet) -> None:
    """Raises UserError where no experiment of the data set is there to estimate from."""
    if not data.estimation():
        raise UserError(
            f'{dataset}: [[experiment]] role: no experiment has the role "estimation"; expected at least one'
        )


def absolute(name: str) -> str:
    """The name of a model with the file part absolute, so that it can be loaded from anywhere."""
    file, colon, model_class = name.rpartition(":")
    return f"{Path(file).resolve()}{colon}{model_class}" if file.endswith(".py") else name


def check_device(name: str) -> str:
    """The device as torch names it. Raises UserError where torch does not know it or this machine does not have it."""
    try:
        device = torch.device(name)
    except RuntimeError:
        device = None
    if device is None or device.type not in ("cpu", "cuda"):
        raise UserError(f'--device {name}: unknown; expected "cpu", "cuda" or "cuda:N"')
    if device.type == "cpu":
        return "cpu"
    count = torch.cuda.device_count() if torch.cuda.is_available() else 0
    if (device.index or 0) >= count:
        have = f"{count} CUDA device{'s' * (count != 1)}" if count else "no CUDA device that torch can use"
        raise UserError(f"--device {name}: this machine has {have}")
    return str(device)


def check_precision(name: str) -> None:
    """Raises UserError where ``name`` is not a precision."""
    if name not in PRECISIONS:
        expected = " or ".join(f'"{precision}"' for precision in PRECISIONS)
        raise UserError(f"--precision {name}: unknown{did_you_mean(name, PRECISIONS)}; expected {expected}")


def check_folder(folder: Path) -> None:
    """Raises UserError where results could not be written to ``folder`` because a file is in the way."""
    nearest = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not nearest.is_dir():
        raise UserError(f"--out {folder}: {nearest} is a file; expected a folder for results")
