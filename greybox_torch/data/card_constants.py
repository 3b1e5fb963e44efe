"""Channels that have one value throughout an experiment, given by the card: a payload, the length of a rope."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card_channels import ChannelEntry, ExperimentEntry
from greybox_torch.data.checks import check_finite
from greybox_torch.errors import did_you_mean, quoted
from greybox_torch.files import toml_key

_OF_A_COLUMN = ("scale", "file_unit", "derivative", "missing")


def as_constant(channel: str, value: float | None = None) -> str:
    """How an experiment on a card gives a channel's constant."""
    return f"constants = {{ {toml_key(channel)} = {'…' if value is None else f'{value:g}'} }}"


def check_constants(channels: Mapping[str, ChannelEntry], experiments: Sequence[ExperimentEntry]) -> None:
    """Raises ValueError where a constant is of no channel, or a channel has neither a column nor a constant in some experiment."""
    for experiment in experiments:
        _check_names(experiment, channels)
    for name, entry in channels.items():
        lacking = [one.name for one in experiments if not _has_source(name, entry, one)]
        if len(lacking) == len(experiments):
            raise ValueError(
                f'[channels], {name}: "column" is missing; expected column = "…", or expr = "…" of several columns, '
                f"or {as_constant(name)} in every [[experiment]] where it has one value throughout"
            )
        if lacking:
            raise ValueError(
                f'[[experiment]] "{lacking[0]}": channel "{name}" has neither a column nor a constant; expected '
                f'column = "…" in [channels], or here columns = {{ {toml_key(name)} = "…" }} or {as_constant(name)}'
            )
        given = [key for key in _OF_A_COLUMN if key in entry.model_fields_set]
        if given and all(name in one.constants for one in experiments):
            unit = f', which is "{entry.unit}"' if entry.unit else ""
            raise ValueError(
                f'[channels], {name}: "{given[0]}" is of a column, and every experiment gives a constant; expected no '
                f"{given[0]}, and constants in the channel's unit{unit}"
            )


def _check_names(experiment: ExperimentEntry, channels: Mapping[str, ChannelEntry]) -> None:
    place = f'[[experiment]] "{experiment.name}", constants'
    for key in experiment.constants:
        if key not in channels:
            raise ValueError(
                f"{place}: no channel is named {quoted(key)}{did_you_mean(key, channels)}; expected {', '.join(channels)}, or a "
                f'line of its own in [channels]: {toml_key(key)} = {{ unit = "…" }}'
            )
        if key in experiment.columns:
            raise ValueError(f'{place}: "{key}" has a column of this experiment as well; expected one of them')
    if all(name in experiment.constants for name in channels):
        raise ValueError(f"{place}: no channel is left that has a column; expected one at least")


def _has_source(name: str, entry: ChannelEntry, experiment: ExperimentEntry) -> bool:
    own = name in experiment.constants or name in experiment.columns
    return own or entry.column is not None or entry.expr is not None


def constants_of(place: str, experiment: ExperimentEntry, samples: int) -> dict[str, NDArray[np.float64]]:
    """By channel, its samples (N,). Raises UserError, beginning with ``place``, for one that is too large."""
    held = {name: np.full(samples, value) for name, value in experiment.constants.items()}
    for name, values in held.items():
        check_finite(values[:1], lambda _, name=name: f"{place}, constants, {name}")
    return held


def told_constants(channels: Mapping[str, ChannelEntry], experiment: ExperimentEntry) -> Iterator[str]:
    """A note of each constant that stands in the place of a column."""
    for name, value in experiment.constants.items():
        entry = channels[name]
        if entry.column is not None or entry.expr is not None:
            unit = f" {entry.unit}" if entry.unit not in ("", "1") else ""
            yield f"{name} is {value:.6g}{unit} throughout, as the card's constants say; its column is not read here"
