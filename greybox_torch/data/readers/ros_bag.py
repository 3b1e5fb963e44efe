"""Bags of ROS 2 in SQLite (`.db3`)."""

from __future__ import annotations

import shlex
import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from greybox_torch.data.readers.robot_log import Message, RobotLog, columns_of_log
from greybox_torch.data.readers.ros_messages import Decoder
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError


def read_ros_bag(path: Path, columns: Collection[str]) -> Table:
    """Reads fields of messages.

    Raises UserError for types of messages that are not known and bags that are still open, and what SQLite raises for a damaged file.
    """
    return columns_of_log(ros_bag(path), columns)


def ros_bag(path: Path) -> RobotLog:
    """The log in a file. Raises UserError where messages are still beside it, and what SQLite raises for a damaged file."""
    _check_closed(path)
    with closing(_opened(path)) as bag:
        topics = bag.execute("SELECT id, name, type, serialization_format FROM topics").fetchall()
        definitions = _definitions(bag)
        counts = dict(bag.execute("SELECT topic_id, count(*) FROM messages GROUP BY topic_id"))
    ids = {name: number for number, name, _, _ in topics}

    def messages(topics: Collection[str]) -> Iterator[Message]:
        names = {ids[name]: name for name in topics}
        marks = ", ".join("?" * len(names))
        query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({marks}) ORDER BY timestamp, id"
        with closing(_opened(path)) as bag:
            for number, stamp, data in bag.execute(query, list(names)):
                yield names[number], stamp, data

    return RobotLog(
        path,
        {
            name: Decoder(path, name, kind, encoding, *definitions.get(kind, ("", "")))
            for _, name, kind, encoding in topics
        },
        {name: counts.get(number, 0) for number, name, _, _ in topics},
        messages,
    )


def _check_closed(path: Path) -> None:
    """Raises UserError where SQLite has not yet moved what was recorded from its log of changes into the file."""
    changes = path.with_name(f"{path.name}-wal")
    if changes.is_file() and changes.stat().st_size:
        raise UserError(
            f"{path}: messages are still in {changes.name} beside it; expected a bag that was closed "
            f'(sqlite3 {shlex.quote(path.name)} "PRAGMA wal_checkpoint(TRUNCATE)" moves them into the file)'
        )


def _definitions(bag: sqlite3.Connection) -> dict[str, tuple[str, str]]:
    """Text and language of the definitions of types, which bags have since the release Iron."""
    tables = {name for (name,) in bag.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if "message_definitions" not in tables:
        return {}
    rows = bag.execute("SELECT topic_type, encoded_message_definition, encoding FROM message_definitions")
    return {kind: (text, language) for kind, text, language in rows}


def _opened(path: Path) -> sqlite3.Connection:
    """The file as it is, which is never written to."""
    return sqlite3.connect(f"file:{quote(str(path))}?mode=ro&immutable=1", uri=True)
