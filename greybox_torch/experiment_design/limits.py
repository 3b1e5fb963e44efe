"""What a new recording may do to the machine: range and rate of inputs, range of outputs and states, seconds."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import Any

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.errors import UserError, did_you_mean, quoted
from greybox_torch.experiment_design.as_recorded import AS_RECORDED, as_recorded, has_range, traces_of
from greybox_torch.model import GreyBoxModel

SECONDS, START = "seconds", "start"
WIDENED = 0.1
"""Share of what was recorded by which outputs may go beyond it, each way, where no limit is given: noise ends no recording."""
ROUNDING = 1e-9
"""Share of its size by which a constant may seem to move: interpolation between equal samples rounds."""

EVERY_INPUT = (
    f'Every input that may move is designed. One that nobody can set, as a recorded temperature, is kept as it was with "{AS_RECORDED}" in '
    "the place of its limits ([limits] on the card, in Python limits=)."
)
"""What a reader has to know of a model with several inputs."""


@dataclass(frozen=True)
class Range:
    """From ``lower`` to ``upper`` in a signal's unit; ``rate`` is the fastest change, in the unit per second."""

    lower: float
    upper: float
    rate: float = math.inf

    @property
    def middle(self) -> float:
        return 0.5 * (self.lower + self.upper)

    @property
    def half(self) -> float:
        return 0.5 * (self.upper - self.lower)


@dataclass(frozen=True)
class Limits:
    """``inputs`` has a range for every input; ``outputs`` and ``states`` for those that are limited. ``seconds``: how long it may be.

    ``set_points`` has the range of the set point for every input that a loop drives. ``begin``: where what is commanded begins, by input,
    of set points and of inputs whose rate is limited. ``start``: states that the recording is to begin with. ``recorded``: inputs and
    outputs that nothing is given for, whose range is what was recorded. ``held``: inputs that no range is given for and that were
    constant in every recording, kept so. ``kept``: by name, inputs (N,) that are as the recording had them that the next one begins like;
    ``not_in_steps`` are those of them that nothing asks for.
    """

    seconds: float
    inputs: Mapping[str, Range]
    outputs: Mapping[str, Range]
    states: Mapping[str, Range]
    set_points: Mapping[str, Range] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    begin: Mapping[str, float] = field(default_factory=dict)
    recorded: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    kept: Mapping[str, np.ndarray] = field(default_factory=dict)
    not_in_steps: tuple[str, ...] = ()

    @property
    def designed(self) -> list[str]:
        """Inputs, or those whose set point, may move."""
        return [name for name, own in self.commanded.items() if own.half > 0.0 and name not in self.kept]

    @property
    def commanded(self) -> dict[str, Range]:
        """By input, the range of what is commanded: the input, or the set point of the loop that drives it."""
        return {name: self.set_points.get(name, own) for name, own in self.inputs.items()}


def limits_of(
    data: DataSet,
    model: GreyBoxModel,
    given: Mapping[str, Any],
    place: str,
    follows: Mapping[str, str] | None = None,
) -> Limits:
    """The limits that are ``given`` by signal; where none are, what was recorded: its range, and the length of the longest recording.

    Args:
        given: as the card's table [limits] has them: ``seconds``, ``start`` by state, and by input, output or state
            ``{ lower, upper, rate }``; of an input ``"recorded"`` as well.
        place: how a message begins.
        follows: the output that each input follows which a loop drives. Set points have the range that the output is given, else what
            was recorded, and its rate.

    Raises:
        UserError: a name that the model does not have, or a limit that cannot be one.
    """
    own = {s.name for s in model.plain.states}
    inputs, outputs = [s.name for s in model.inputs], [s.name for s in model.outputs]
    # an output may be called as the state that it shows
    signals = list(dict.fromkeys([*inputs, *outputs, *sorted(own)]))
    known = list(dict.fromkeys([*signals, SECONDS, START]))
    for name in given:
        if name not in known:
            raise UserError(
                f"{place} {name}: no input, output or state is named so{did_you_mean(name, known)}; expected one of {', '.join(known)}"
            )
    recorded = max(r.seconds for r in data.recordings)
    seconds = _positive(given.get(SECONDS, recorded), f"{place} {SECONDS}")
    open_ones = [n for n in inputs if n not in (follows or {})]
    ranges = {
        n: _range(_own(given, n, open_ones), f"{place} {n}", _recorded(data, n, 0.0), may_rest=True) for n in inputs
    }
    held = tuple(n for n in open_ones if not has_range(given.get(n)) and _constant(data, n))
    kept = as_recorded(data, [n for n in open_ones if n not in held], given, driven=bool(follows))
    found = Limits(
        seconds,
        ranges,
        {n: _range(given.get(n), f"{place} {n}", _recorded(data, n, WIDENED)) for n in outputs},
        {n: _range(entry, f"{place} {n}", None) for n, entry in given.items() if n in own and n not in outputs},
        {n: _range(given.get(o), f"{place} {o}", _recorded(data, o, 0.0)) for n, o in (follows or {}).items()},
        {} if START in signals else _start(given.get(START, {}), sorted(own), f"{place} {START}"),
        recorded=tuple(n for n in (*inputs, *outputs) if n not in given and n not in (*held, *kept)),
        held=held,
        kept=dict.fromkeys(kept, np.empty(0)),
        not_in_steps=tuple(n for n in kept if given.get(n) != AS_RECORDED),
    )
    return held_as_in(found, data.recordings[0], data.recordings[0].sample_time)


def held_as_in(limits: Limits, recording: Recording, step: float) -> Limits:
    """The limits with the inputs that are ``held`` or ``kept`` as they were in a recording: the one that the next begins like.

    Args:
        step: the sample time of the next one, s.
    """
    at = {name: float(np.nanmedian(recording.signals[name])) for name in limits.held}
    return replace(
        limits,
        inputs=dict(limits.inputs) | {n: replace(limits.inputs[n], lower=v, upper=v) for n, v in at.items()},
        kept=traces_of(recording, list(limits.kept), step),
    )


def _own(given: Mapping[str, Any], name: str, open_ones: Sequence[str]) -> Any:
    """What is given for an input; nothing where it is to be as recorded, which one that a loop drives cannot be."""
    return None if given.get(name) == AS_RECORDED and name in open_ones else given.get(name)


def _constant(data: DataSet, name: str) -> bool:
    """Whether a channel has one value throughout each of the recordings, if another one in each."""
    ranges = [(np.nanmin(r.signals[name]), np.nanmax(r.signals[name])) for r in data.recordings]
    return all(high - low <= ROUNDING * max(abs(low), abs(high)) for low, high in ranges)


def _start(entry: Any, states: list[str], place: str) -> dict[str, float]:
    if not isinstance(entry, Mapping):
        raise UserError(f"{place}: found {entry!r}, expected states and their values, {{ {states[0]} = 0.0 }}")
    for name in entry:
        if name not in states:
            raise UserError(
                f"{place}: no state is named {name}{did_you_mean(name, states)}; expected some of {', '.join(states)}"
            )
    return {name: _number(value, f"{place}, {name}") for name, value in entry.items()}


def _recorded(data: DataSet, name: str, widened: float) -> Range:
    values = np.concatenate([r.signals[name] for r in data.recordings])
    lower, upper = float(np.nanmin(values)), float(np.nanmax(values))
    more = widened * (upper - lower)
    return Range(lower - more, upper + more)


def _range(entry: Any, place: str, default: Range | None, *, may_rest: bool = False) -> Range:
    """``may_rest``: of an input, which can be kept at one value, `lower = upper`."""
    if entry is None:
        assert default is not None
        return default
    if not isinstance(entry, Mapping) or not set(entry) <= {"lower", "upper", "rate"}:
        raise UserError(
            f"{place}: found {quoted(entry)}; expected {{ lower = …, upper = …, rate = … }}, or some of these"
            f"{f', or {quoted(AS_RECORDED)}' if may_rest else ''}"
        )
    lower = _number(entry.get("lower", -math.inf if default is None else default.lower), f"{place}, lower")
    upper = _number(entry.get("upper", math.inf if default is None else default.upper), f"{place}, upper")
    if not (lower < upper or (may_rest and lower == upper)):
        raise UserError(f"{place}: lower = {lower:g} is not below upper = {upper:g}; expected a range, lower first")
    return Range(lower, upper, _positive(entry.get("rate", math.inf), f"{place}, rate"))


def _positive(value: Any, place: str) -> float:
    number = _number(value, place)
    if not number > 0:
        raise UserError(f"{place}: found {value!r}, expected a number above zero")
    return number


def _number(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, Real) or value != value:
        raise UserError(f"{place}: found {value!r}, expected a number")
    return float(value)
