"""What is written of a designed recording: what to command, and a card for what is recorded."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.files import toml_key, toml_text

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


def csv_text(time: np.ndarray, columns: Mapping[str, np.ndarray]) -> str:
    """The columns (N,) over time (N,) in s."""
    lines = [",".join(["time", *columns])]
    for k, t in enumerate(time):
        lines.append(",".join(f"{v:.9g}" for v in (t, *(u[k] for u in columns.values()))))
    return "\n".join(lines) + "\n"


def card_text(data: DataSet, time: np.ndarray, reference: str) -> str:
    """A card for the recording that is asked for, of a model by its ``reference``."""
    channels = "\n".join(
        f"{toml_key(name)} = {{ column = {toml_text(name)}, unit = {toml_text(channel.unit)} }}"
        for name, channel in data.channels.items()
    )
    return (
        f"# A card for the recording that {INPUT} asks for. Save what you record as {RECORDED}, with these columns.\n"
        f"# To diagnose old and new recordings together, copy the [[experiment]] below to the card of the old ones.\n"
        f"name = {toml_text(f'{data.name}: designed recording')}\n"
        f"sample_time = {float(time[1] - time[0])!r}\n"
        f'hold = "{data.hold}"\n\n[channels]\n{channels}\n\n'
        f'[[experiment]]\nname = "Designed"\nfile = "{RECORDED}"\nrole = "estimation"\n\n'
        f"[model]\nname = {toml_text(reference)}\n"
    )
