"""`greybox inspect`: reads and checks a data set, tabulates and plots every channel of every experiment."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from greybox_torch.commands.options import Options
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.files import replacing

if TYPE_CHECKING:
    from rich.table import Table

FIGURE = "channels.png"


def run(dataset: Path, options: Options) -> None:
    """Prints a table or JSON of the channels, and writes their figure.

    Where the user or the card names a model, the card is checked against it. Raises UserError where anything is wrong.
    """
    data = load_dataset(dataset)
    model = options.model or data.model
    if model is not None:
        _check_against(model, data)
    result = {**summarize(data), "model": model}
    figure = options.folder(dataset) / FIGURE
    _write_figure(data, figure)
    _print_tables(data, result, figure, options)
    options.print_json({**result, "figure": str(figure)})


def _check_against(model: str, data: DataSet) -> None:
    """Raises UserError where the card's channels, parameters or start states are not the model's."""
    from greybox_torch.estimate.problem import make_problem
    from greybox_torch.systems import load_model

    make_problem(data, load_model(model), data.recordings)


def summarize(data: DataSet) -> dict[str, Any]:
    """Extent, spread and gaps of every channel, in its unit, as `greybox inspect --json` prints them."""
    return {
        "schema": "greybox-inspect/1",
        "dataset": data.name,
        "held_out_by_default": data.held_out_by_default,
        "experiments": [
            {
                "name": recording.name,
                "role": recording.role,
                "channels": {
                    name: {
                        "samples": len(values),
                        "sample_time": recording.sample_time,
                        "min": float(np.nanmin(values)),
                        "max": float(np.nanmax(values)),
                        "std": float(np.nanstd(values)),
                        "missing": int(np.isnan(values).sum()),
                        "unit": data.channels[name].unit,
                    }
                    for name, values in recording.signals.items()
                },
            }
            for recording in data.recordings
        ],
    }


def _write_figure(data: DataSet, path: Path) -> None:
    from greybox_torch.report.channels import plot_channels

    figure = plot_channels(data)
    with replacing(path) as temporary:
        figure.savefig(temporary)


def _print_tables(data: DataSet, result: dict[str, Any], figure: Path, options: Options) -> None:
    from rich.text import Text

    console = options.console()
    console.print(Text(data.name, style="bold"))
    for recording, experiment in zip(data.recordings, result["experiments"], strict=True):
        seconds = recording.time[-1] - recording.time[0]
        file = "" if recording.source is None else f"{recording.source.name}, "
        what = f"{file}rows = {list(recording.rows)}, {seconds:.6g} s"
        console.print(Text.assemble("\n", (f"{recording.name} ({recording.role})", "bold"), f": {what}"))
        console.print(_table(experiment["channels"]))
    if data.held_out_by_default:
        console.print('The card gives no experiment the role "validation": the last quarter of each is held out.\n')
    if result["model"] is not None:
        console.print(Text(f"Channels, parameters and start states fit the model {result['model']}."), soft_wrap=True)
    console.print(Text(f"Figure: {figure}"), soft_wrap=True)


def _table(channels: dict[str, dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    table = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("channel", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for heading in ("samples", "sample time [s]", "min", "max", "std", "missing"):
        table.add_column(Text(heading), justify="right")
    for name, channel in channels.items():
        numbers = (f"{channel[key]:.4g}" for key in ("sample_time", "min", "max", "std"))
        table.add_row(Text(name), Text(channel["unit"]), str(channel["samples"]), *numbers, str(channel["missing"]))
    return table
