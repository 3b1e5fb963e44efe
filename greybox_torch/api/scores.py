"""Fit and error of models on experiments: as rows, as JSON, and on the console."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.api.result import HELD_OUT
from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Score
from greybox_torch.model import Output
from greybox_torch.report.tables import print_table
from greybox_torch.simulation.substeps import LARGEST

Scores = Mapping[str, Sequence[Score]]
"""By model ("start", "refit", "augmented", …), all in the order of the data set's experiments."""


def squared_unit(outputs: Sequence[Output]) -> str:
    """The unit of a mean squared error, behind the number: of several outputs each one's error is divided by the output's spread."""
    if len(outputs) > 1:
        return " (each output's error over its spread)"
    unit = outputs[0].unit if outputs else ""
    return "" if unit in ("", "1") else f" {unit}^2" if unit.isalpha() else f" ({unit})^2"


def score_rows(data: DataSet, scores: Scores) -> list[dict[str, Any]]:
    """A row for every output of every experiment simulated by every model: fit in %, root mean square error in the output's unit."""
    return [
        {"model": name, **row, "unit": data.channels[row["output"]].unit}
        for name, own in scores.items()
        for row in scores_json(own)
    ]


def scores_json(scores: Sequence[Score]) -> list[dict[str, Any]]:
    """Rows as the contract wants them."""
    return [
        {"experiment": s.experiment, "role": s.role, "output": s.output, "fit": s.fit, "rmse": s.rmse} for s in scores
    ]


def scores_side_by_side(scores: Scores) -> list[dict[str, Any]]:
    """A row for every output of every experiment, with fit and error of each model under its name."""
    rows = []
    for together in zip(*(scores_json(own) for own in scores.values()), strict=True):
        place = {k: v for k, v in together[0].items() if k not in ("fit", "rmse")}
        numbers = [{"fit": row["fit"], "rmse": row["rmse"]} for row in together]
        rows.append(place | dict(zip(scores, numbers, strict=True)))
    return rows


def print_scores(console: Console, data: DataSet, scores: Scores) -> None:
    """A line for every output of every experiment, with the fit and the error of each model."""
    columns, rows = score_table(data, scores)
    print_table(console, columns, rows, prose=["experiment"])
    if data.held_out_by_default:
        console.print(f"{HELD_OUT}\n", soft_wrap=True)


def score_table(data: DataSet, scores: Scores) -> tuple[list[str], list[list[str | float]]]:
    """Headings and rows of the table of scores."""
    columns = [
        "experiment",
        "role",
        "output",
        *[f"{name}\n{what}" for name in scores for what in ("fit [%]", "rmse")],
        "unit",
    ]
    rows = []
    for together in zip(*scores.values(), strict=True):
        first = together[0]
        numbers = [cell for score in together for cell in _cells(score)]
        rows.append([first.experiment, first.role, first.output, *numbers, data.channels[first.output].unit])
    return columns, rows


def _cells(score: Score) -> tuple[str | float, str | float]:
    return (score.fit, score.rmse) if np.isfinite(score.rmse) else ("overflow", "overflow")


def print_substeps(console: Console, substeps: int, name: str = "") -> None:
    """Says so where a sample takes more than one step of the integration."""
    if substeps > 1:
        of = f" of {name}" if name else ""
        doubt = ", which may still be too few" if substeps == LARGEST else ""
        console.print(
            Text(
                f"Each sample{of} is simulated in {substeps} Runge-Kutta steps{doubt}: the motion is fast for the sample time."
            ),
            soft_wrap=True,
        )
