"""Options of the command line, those that several commands take among them: how they are written, and what help says of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from greybox_torch.commands.seconds import seconds

DataSetFile = Annotated[Path, typer.Argument(metavar="DATASET.toml", help="The data card beside the recordings.")]
Model = Annotated[
    str | None,
    typer.Option(metavar="NAME", help='A built-in system, or "my_motor.py:Motor"; wins over the model in the card.'),
]
Checkpoint = Annotated[
    Path | None,
    typer.Option(metavar="RESULTS", help="Results of fit, train or diagnose, to take the place of the start values."),
]
Out = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Where to write results.", show_default="results/<folder of the card>[-<card>]"),
]
Seed = Annotated[int, typer.Option(min=0, max=2**32 - 1, help="Seed of the random numbers.")]
Device = Annotated[str, typer.Option(help='Where to compute: "cpu", "cuda", "cuda:1".')]
Precision = Annotated[
    str,
    typer.Option(
        metavar="single|double", help="Numbers of 32 or 64 bits; keep double unless you know that single is enough."
    ),
]
Settings = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.toml", help="Thresholds and budgets of the search, by name; win over those on the card."
    ),
]
Starts = Annotated[
    int | None,
    typer.Option(
        min=1,
        max=4096,
        metavar="N",
        help="How many start values to try, drawn around those given.",
        show_default="those given; many where they are poor",
    ),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        metavar="SECONDS", parser=seconds("time_limit"), help="After this time the best answer so far is given."
    ),
]
Pdf = Annotated[bool, typer.Option("--pdf", help="Also write the report for print, report.pdf.")]
Json = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON on standard output, all else on standard error.")
]
