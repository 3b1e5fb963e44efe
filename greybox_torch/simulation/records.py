"""The recorded signals of several experiments end to end, as the stepper reads them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.data.steps import steps_of
from greybox_torch.data.units import written_alike
from greybox_torch.errors import UserError, check_none
from greybox_torch.files import toml_key
from greybox_torch.model import GreyBoxModel, Input, Output
from greybox_torch.simulation.driven_inputs import check_controller
from greybox_torch.simulation.units_of_channels import other_unit

Found = TypeVar("Found")


@dataclass(frozen=True)
class Records:
    """Inputs u (n_u, N), outputs y (n_y, N), steps dt (N,) in s, and where each experiment begins and ends.

    Experiment e occupies the samples ``first[e]`` to ``last[e]``, both inclusive. Missing samples of inputs are held from the sample
    before (an input always has some value); those of outputs stay NaN and carry no weight.
    """

    u: np.ndarray
    y: np.ndarray
    dt: np.ndarray
    first: np.ndarray
    last: np.ndarray
    names: tuple[str, ...]
    hold: str

    @property
    def lengths(self) -> np.ndarray:
        return self.last - self.first + 1

    def experiments(self, samples: np.ndarray) -> np.ndarray:
        """Index of the experiment that each of ``samples`` (W,) belongs to, shape (W,)."""
        return np.searchsorted(self.first, samples, side="right") - 1

    def span(self, experiment: int) -> slice:
        """The samples of one experiment."""
        return slice(int(self.first[experiment]), int(self.last[experiment]) + 1)

    def time(self, experiment: int) -> np.ndarray:
        """Time since the start of one experiment, s."""
        return np.concatenate([[0.0], np.cumsum(self.dt[self.span(experiment)][:-1])])

    def part(self, spans: Sequence[slice], names: Sequence[str]) -> Records:
        """The records of some stretches, each an experiment of its own."""
        index = np.concatenate([np.arange(s.start, s.stop) for s in spans])
        lengths = np.array([s.stop - s.start for s in spans])
        first = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.int64)
        return Records(
            self.u[:, index], self.y[:, index], self.dt[index], first, first + lengths - 1, tuple(names), self.hold
        )


def once(records: Records, key: Hashable, make: Callable[[], Found]) -> Found:
    """What ``make`` gives, made once for ``records``, whose samples never change: passes over them ask for it again and again."""
    kept = vars(records).setdefault("_kept", {})
    if key not in kept:
        kept[key] = make()
    return kept[key]


def make_records(dataset: DataSet, model: GreyBoxModel, recordings: Sequence[Recording]) -> Records:
    """Join ``recordings`` into one records for ``model``.

    Raises:
        UserError: the data set has no channel for an input or output of the model, has one in another unit, or has one more.
    """
    check_channels(dataset, model)
    lengths = np.array([len(r.time) for r in recordings])
    first = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.int64)
    u = [[_held(r.signals[i.name]) for r in recordings] for i in model.inputs]
    y = [[r.measured(o.name) for r in recordings] for o in model.outputs]
    dt = [np.append(steps_of(r.time), r.sample_time) for r in recordings]
    total = int(lengths.sum())
    return Records(
        u=np.ascontiguousarray([np.concatenate(row) for row in u]).reshape(len(u), total),
        y=np.ascontiguousarray([np.concatenate(row) for row in y]).reshape(len(y), total),
        dt=np.concatenate(dt),
        first=first,
        last=first + lengths - 1,
        names=tuple(r.name for r in recordings),
        hold=dataset.hold,
    )


def check_channels(dataset: DataSet, model: GreyBoxModel) -> None:
    """Whether the channels of a data set are the inputs and outputs of a model, in the same units, and its controller drives inputs.

    Raises:
        UserError: naming the file, the channel, and what the model expects.
    """
    declared = {s.name: s for s in (*model.inputs, *model.outputs)}
    for name, signal in declared.items():
        if name not in dataset.channels:
            found = ", ".join(dataset.channels)
            raise UserError(
                f"{dataset.place('[channels]')} has no '{name}', which model {model.title} needs; found: {found}; "
                f"expected {_missing(dataset, signal, model)}"
            )
    check_none(list(_other_units(dataset, model, declared)), dataset.place("[channels]"), before_one=" ")
    strange = [name for name in dataset.channels if name not in declared]
    if strange:
        of_a_frame = (
            '; which columns of a frame are channels, columns = {"channel": "column", …} says'
            if dataset.path is None
            else ""
        )
        raise UserError(
            f"{dataset.place('[channels]')} {', '.join(strange)}: model {model.title} has no such signal; "
            f"expected one of {', '.join(declared)}, or no such channel{of_a_frame}"
        )
    check_controller(dataset.controller, model, dataset.place("[controller]"))


def _other_units(dataset: DataSet, model: GreyBoxModel, declared: Mapping[str, Input | Output]) -> Iterator[str]:
    """What is wrong with the units of channels, all of them at once."""
    for name, signal in declared.items():
        channel = dataset.channels[name]
        if channel.unit and signal.unit and not written_alike(channel.unit, signal.unit):
            yield (
                f"{name}: unit is '{channel.unit}', model {model.title} expects '{signal.unit}'; "
                f"{other_unit(dataset, channel, signal.unit)}"
            )


def _missing(dataset: DataSet, signal: Input | Output, model: GreyBoxModel) -> str:
    """What is to be written for a signal that the data set has no channel for."""
    if dataset.path is None:
        line = f"a channel '{signal.name}' in {signal.unit or 'its unit'}"
    else:
        line = f'a line such as {toml_key(signal.name)} = {{ column = "…", unit = "{signal.unit}" }}'
    without_sensor = "; an output that no sensor shows is left out of the model's outputs"
    return line + (without_sensor if any(o.name == signal.name for o in model.outputs) else "")


def _held(values: np.ndarray) -> np.ndarray:
    """Fill missing samples with the value before (the first ones with the first known)."""
    missing = np.isnan(values)
    if not missing.any():
        return values
    known = np.where(~missing, np.arange(len(values)), -1)
    index = np.maximum.accumulate(known)
    return values[np.where(index < 0, int(np.argmax(~missing)), index)]
