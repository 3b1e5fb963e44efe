"""What is written of a designed recording: what to command, and a card for what is recorded."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.data.card import Card, card_at
from greybox_torch.data.card_channels import Entry
from greybox_torch.files import absolute, toml_key, toml_text

INPUT, FIGURE, CARD, RECORDED = "design.csv", "design.png", "next.toml", "recorded.csv"


def columns_of(
    inputs: Mapping[str, np.ndarray], set_points: Mapping[str, np.ndarray], follows: Mapping[str, str]
) -> dict[str, np.ndarray]:
    """The columns (N,) of the file: inputs that are set, then set points, then what the loops are expected to make of them.

    Args:
        set_points: by output.
        follows: the output that each input follows which a loop drives.
    """
    set_ones = {name: u for name, u in inputs.items() if name not in follows}
    points = {f"{name}_set_point": r for name, r in set_points.items()}
    return set_ones | points | {f"{name}_expected": inputs[name] for name in follows}


def units_of(data: DataSet, follows: Mapping[str, str]) -> dict[str, str]:
    """The unit of each of :func:`columns_of`; empty for a number."""
    units = {name: channel.unit for name, channel in data.channels.items()}
    points = {f"{output}_set_point": units[output] for output in follows.values()}
    return units | points | {f"{name}_expected": units[name] for name in follows}


def csv_text(time: np.ndarray, columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> str:
    """The columns (N,) over time (N,) in s, with their units in the header where ``units``, by column, has one."""
    headings = [f"{name} [{unit}]" if (unit := units.get(name)) else name for name in columns]
    lines = [",".join(["time [s]", *headings])]
    for k, t in enumerate(time):
        lines.append(",".join(f"{v:.9g}" for v in (t, *(u[k] for u in columns.values()))))
    return "\n".join(lines) + "\n"


def card_text(data: DataSet, time: np.ndarray, reference: str, folder: Path, remarks: Iterable[str] = ()) -> str:
    """A card in ``folder`` for the recording that is asked for, of a model by its ``reference``.

    Columns, their units and the time stamps are as on the card of the old recordings, so that the experiment can be copied there.
    ``remarks`` are sentences for its head.
    """
    card = card_at(data.path)
    step, old = float(time[1] - time[0]), "that of the old ones" if data.path is None else _seen_from(data.path, folder)
    lines = [f"sample_time = {float(f'{step:.9g}')!r}"] if card is None else _clock(card, step)
    lines += [f'hold = "{data.hold}"', "", "[channels]"]
    for name, channel in data.channels.items():
        own = (
            {"column": name, "unit": channel.unit} if card is None else _of_a_column(name, _given(card.channels[name]))
        )
        lines.append(f"{toml_key(name)} = {_table(own)}")
    told = "\n".join(lines)
    return (
        f"# A card for the recording that {INPUT} asks for. Save what you record as {RECORDED}, with these columns in these units.\n"
        f"# To diagnose old and new recordings together, copy the [[experiment]] below to the card {old}, and {RECORDED} beside it.\n"
        f"{''.join(f'# {remark}' + chr(10) for remark in remarks)}"
        f"name = {toml_text(f'{data.name}: designed recording')}\n{told}\n\n"
        f'[[experiment]]\nname = "Designed"\nfile = "{RECORDED}"\nrole = "estimation"\n\n'
        f"[model]\nname = {toml_text(_model(reference, folder))}\n"
    )


def _clock(card: Card, step: float) -> list[str]:
    """What a card says of time, whose samples are ``step`` s apart in the end."""
    given = {key: getattr(card, key) for key in ("sample_time", "resample", "decimate")}
    lines = [f"{key} = {value!r}" for key, value in given.items() if value is not None]
    time = None if card.time is None else _given(card.time)
    return lines if time is None else [f"time = {_table(time)}    # samples {step:.9g} s apart", *lines]


def _given(entry: Entry) -> dict[str, Any]:
    """What a table of a card says, columns by position as numbers."""
    given = {key: getattr(entry, key) for key in type(entry).model_fields if key in entry.model_fields_set}
    column = given.get("column") or ""
    return given | ({"column": int(column[1:])} if re.fullmatch(r"#\d+", column) else {})


def _of_a_column(name: str, given: dict[str, Any]) -> dict[str, Any]:
    """With a column of the channel's name, where the old recordings have a constant, or columns of their own."""
    return given if "column" in given or "expr" in given else {"column": name, **given}


def _table(given: Mapping[str, Any]) -> str:
    return f"{{ {', '.join(f'{k} = {toml_text(v) if isinstance(v, str) else repr(v)}' for k, v in given.items())} }}"


def _model(reference: str, folder: Path) -> str:
    file, colon, name = reference.rpartition(":")
    return f"{_seen_from(Path(file), folder)}{colon}{name}" if file.endswith(".py") else reference


def _seen_from(file: Path, folder: Path) -> str:
    """A path relative to a folder, absolute where they are on different drives."""
    try:
        return Path(os.path.relpath(absolute(file), absolute(folder))).as_posix()
    except ValueError:
        return str(absolute(file))
