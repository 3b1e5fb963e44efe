"""`greybox inspect`: reads and checks a data set, tabulates and plots every channel of every experiment."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.inspect import inspect
from greybox_torch.commands.options import Options
from greybox_torch.commands.results_folder import check_folder
from greybox_torch.data import load_dataset


def run(dataset: Path, options: Options) -> None:
    """Looks at every channel; where the user or the card names a model, the card is checked against it. Writes a figure."""
    folder = options.folder(dataset)
    check_folder(folder)
    options.finish(inspect(load_dataset(dataset), options.model), folder)
