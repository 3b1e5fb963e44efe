"""What hypotheses that cannot be told apart have in common, as one statement."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.one_of import spoken, spoken_at
from greybox_torch.in_unit import in_unit

TIME_SHIFT = "a time shift"
"""The nature of delays and lags, which have a statement of their own."""

LIKE_SIZES = 1.5
"""Largest ratio of two sizes that are told as one."""


@dataclass(frozen=True)
class Member:
    """A hypothesis as a statement needs it.

    ``signal``: the input or output that it changes, where it does; ``size`` in ``unit``, None where the law has no single one.
    """

    port: str
    mechanism: str
    nature: str
    probability: float
    signal: str = ""
    is_sensor: bool = False
    size: float | None = None
    unit: str = ""


def statement(members: Sequence[Member]) -> str:
    """One statement that is true whichever of the members is right."""
    natures = {m.nature for m in members}
    if natures == {TIME_SHIFT}:
        return _time_shift(members)
    if len(natures) == 1 and "" not in natures:
        size = common_size(members)
        return f"{natures.pop()}{f' of about {size}' if size else ''} at {_either(m.port for m in members)}"
    if len({m.port for m in members}) == 1:
        return f"{_either(spoken(m.mechanism) for m in members)} at {members[0].port}"
    return ", or ".join(dict.fromkeys(spoken_at(m.mechanism, m.port) for m in members))


def common_size(members: Sequence[Member]) -> str:
    """The size that the members agree on, weighted by their probabilities, with its unit; empty where they do not."""
    sizes = [abs(m.size) for m in members if m.size is not None]
    if len(sizes) < len(members) or len({m.unit for m in members}) > 1 or max(sizes) > LIKE_SIZES * min(sizes):
        return ""
    whole = sum(m.probability for m in members)
    mean = sum(m.probability * size for m, size in zip(members, sizes, strict=True)) / max(whole, 1e-300)
    return _with_unit(mean, members[0].unit)


def _time_shift(members: Sequence[Member]) -> str:
    inputs = _either(m.signal for m in members if not m.is_sensor)
    outputs = _either(m.signal for m in members if m.is_sensor)
    size = common_size(members)
    time = f"about {size}" if size else "some time"
    passes = "pass" if size else "passes"
    if not outputs:
        return f"{time} {passes} before {inputs} acts"
    if not inputs:
        return f"{time} {passes} before {outputs} is recorded"
    return f"{time} {passes} between {inputs} and measured {outputs}"


def _either(names: Iterable[str]) -> str:
    return " or ".join(dict.fromkeys(names))


def _with_unit(value: float, unit: str) -> str:
    if unit == "s" and 0 < value < 0.1:
        return f"{digits(1e3 * value)} ms"
    return in_unit(digits(value), unit)
