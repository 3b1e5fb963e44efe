"""The options of the command line that several commands take: how they are written, and what help says of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

DataSetFile = Annotated[Path, typer.Argument(metavar="DATASET.toml", help="The data card beside the recordings.")]
Model = Annotated[
    str | None,
    typer.Option(metavar="NAME", help='A built-in system, or "my_motor.py:Motor"; wins over the model in the card.'),
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
Pdf = Annotated[bool, typer.Option("--pdf", help="Also write the report for print, report.pdf.")]
Json = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON on standard output, all else on standard error.")
]
