"""Columns of a robot's log: fields of the messages of a topic, such as "/joint_states.position[0]", and "TOPIC.time".

A topic's time is in seconds since 1970: that of the message's header where it has one, else when it was recorded. Topics have times of
their own: the first column that is asked for by the name of a time decides (else the first column), and columns of other topics are
brought to its times on straight lines, which is told.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.checks import check_time
from greybox_torch.data.processing import at_times
from greybox_torch.data.readers.column import Element, Field, Step, steps_of
from greybox_torch.data.readers.table import MOST_SAMPLES, NoSuchColumn, Table, require
from greybox_torch.errors import UserError

TIME = "time"
NANO = 1e-9

Message = tuple[str, int, bytes]
"""Topic, time of recording in nanoseconds since 1970, and the message as it stands in the file."""


@dataclass(frozen=True)
class RobotLog:
    """A log: how the messages of each topic are decoded, how many there are (0: not known), and all messages of some topics, in order."""

    path: Path
    decoders: Mapping[str, Callable[[bytes], Any]]
    counts: Mapping[str, int]
    messages: Callable[[Collection[str]], Iterator[Message]]

    @property
    def topics(self) -> list[str]:
        """The one with most messages first."""
        return sorted(self.decoders, key=lambda topic: -self.counts.get(topic, 0))


def columns_of_log(log: RobotLog, columns: Collection[str]) -> Table:
    """The columns (N,) as a table. Raises UserError for a topic or field that is not there, and for one that holds no numbers."""
    asked = {column: _topic_and_steps(log, column) for column in columns}
    clocks = [topic for topic, steps in asked.values() if steps == [Field(TIME)]]
    main = next(iter([*clocks, *(topic for topic, _ in asked.values())]), "")
    stamps, held = _read(log, asked)
    notes = []
    for column, (topic, _) in asked.items():
        if topic != main:
            check_time(
                stamps[topic], lambda k, topic=topic: f'{log.path}, topic "{topic}", message {k} (the first is 0)'
            )
            held[column] = at_times(stamps[main], stamps[topic], held[column])
            notes.append(f'column "{column}" is brought to the times of {main} on straight lines between its messages')
    units = {column: "s" for column, (_, steps) in asked.items() if steps == [Field(TIME)]}
    return Table(log.path, held, units=units, notes=tuple(notes))


def _topic_and_steps(log: RobotLog, column: str) -> tuple[str, list[Step]]:
    topic, _, inner = column.partition(".")
    require(log.path, [] if topic in log.decoders else [topic], log.topics)
    try:
        steps = steps_of(inner)
    except ValueError:
        steps = []
    if not steps:
        raise UserError(
            f'{log.path}, column "{column}": expected a field of the topic, like "{topic}.position[0]", or "{topic}.time"'
        )
    return topic, steps


def _read(
    log: RobotLog, asked: Mapping[str, tuple[str, list[Step]]]
) -> tuple[dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]]]:
    """Times by topic, values by column."""
    topics = {topic for topic, _ in asked.values()}
    times: dict[str, list[float]] = {topic: [] for topic in topics}
    values: dict[str, list[float]] = {column: [] for column in asked}
    for topic, recorded, raw in log.messages(topics):
        message = log.decoders[topic](raw)
        times[topic].append(NANO * (header_time(message) or recorded))
        if len(times[topic]) > MOST_SAMPLES:
            raise UserError(
                f'{log.path}: topic "{topic}" has more than {MOST_SAMPLES:.0e} messages; expected a shorter log'
            )
        for column, (of, steps) in asked.items():
            if of == topic:
                at_time = steps == [Field(TIME)]
                values[column].append(times[topic][-1] if at_time else _value(log.path, column, message, steps))
    for column in asked:
        if not values[column]:
            raise NoSuchColumn(f'{log.path}, column "{column}": the topic has no messages', column)
        if np.isnan(values[column]).all():
            raise NoSuchColumn(f'{log.path}, column "{column}": no message has as many elements', column)
    arrays = {topic: np.array(found) for topic, found in times.items()}
    return arrays, {column: np.array(found) for column, found in values.items()}


def header_time(message: Any) -> int:
    """Nanoseconds since 1970 by the message's header; zero where it has none."""
    stamp = member(member(message, "header"), "stamp")
    seconds = member(stamp, "sec")
    return (
        0
        if seconds is None
        else int(seconds) * 1_000_000_000 + int(member(stamp, "nanosec") or member(stamp, "nsec") or 0)
    )


def member(value: Any, name: str) -> Any:
    """A field of a message, of ROS or of JSON; None where it is not there."""
    return value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)


def _value(path: Path, column: str, message: Any, steps: list[Step]) -> float:
    """The number that the steps lead to; NaN where a list is too short in this message."""
    value = message
    for step in steps:
        if isinstance(step, Field):
            value = member(value, step.name)
            if value is None:
                raise NoSuchColumn(f'{path}, column "{column}": the messages have no field "{step.name}"', column)
        elif isinstance(step, Element) and hasattr(value, "__getitem__") and not isinstance(value, str | Mapping):
            if step.index >= len(value):
                return float("nan")
            value = value[step.index]
        else:
            raise UserError(f'{path}, column "{column}": what stands before the brackets has no elements')
    if not isinstance(value, bool | int | float | np.generic) or isinstance(value, np.str_):
        what = "text" if isinstance(value, str) else "no single number"
        raise UserError(
            f'{path}, column "{column}": holds {what}; expected a number, such as one element "{column}[0]"'
        )
    return float(value)
