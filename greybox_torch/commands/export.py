"""`greybox export`: the model of a fit, a training or a diagnosis as C, as a module of torch, or as an FMU."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.export import check_kind, export
from greybox_torch.commands.options import Options
from greybox_torch.commands.results_folder import check_folder
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel
from greybox_torch.restored import load, load_beside
from greybox_torch.result_names import MODEL
from greybox_torch.systems import load_model


def run(results: Path, to: str, dataset: Path | None, name: str | None, step: float | None, options: Options) -> None:
    """Writes the files to --out, by default beside the checkpoint."""
    check_kind(to)
    stem = results / MODEL if results.is_dir() else results
    folder = options.out if options.out is not None else stem.parent / to
    check_folder(folder)
    model, data = _loaded(stem, dataset, options)
    found = export(model, to=to, data=data, name=name, step=step)
    options.finish(found, folder)


def _loaded(stem: Path, dataset: Path | None, options: Options) -> tuple[GreyBoxModel, DataSet | None]:
    if dataset is None:
        return load(stem, options.model), None
    data = load_dataset(dataset)
    own = options.model or data.model
    if own is None:
        raise UserError(f"{dataset}: [model] name is missing and no --model is given; expected one of them")
    return load_beside(stem, load_model(own), data)
