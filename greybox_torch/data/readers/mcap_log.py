"""MCAP logs (mcap.dev), of ROS 2, ROS 1 or in JSON."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from greybox_torch.data.readers.robot_log import Message, RobotLog, columns_of_log
from greybox_torch.data.readers.ros_messages import NEEDED, Decoder
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError

UNPACKED = 2**28
"""Bytes by which a record, packed in its chunk, may be longer than the file; what declares more is not believed."""


def read_mcap(path: Path, columns: Collection[str]) -> Table:
    """Reads fields of messages. Raises UserError for damaged files, and for messages that are neither of ROS nor in JSON."""
    return columns_of_log(mcap_log(path), columns)


def mcap_log(path: Path) -> RobotLog:
    """The log in a file. Raises UserError where the package is not installed, or what that raises for a damaged file."""
    try:
        from mcap.reader import SeekingReader
    except ImportError:
        raise UserError(f"{path}: logs in MCAP need a package more; install it by {NEEDED}") from None
    longest = path.stat().st_size + UNPACKED
    with path.open("rb") as file:
        summary = SeekingReader(file, record_size_limit=longest).get_summary()
    if summary is None or not summary.channels:
        raise UserError(
            f"{path}: has no summary of its topics, as if the recorder was cut off; `mcap recover` writes one"
        )
    decoders = {}
    for channel in summary.channels.values():
        schema = summary.schemas.get(channel.schema_id)
        told = (
            ("", "", "") if schema is None else (schema.name, schema.data.decode("utf-8", "replace"), schema.encoding)
        )
        decoders[channel.topic] = Decoder(path, channel.topic, told[0], channel.message_encoding, *told[1:])
    counted = {} if summary.statistics is None else summary.statistics.channel_message_counts
    counts = {channel.topic: counted.get(channel.id, 0) for channel in summary.channels.values()}

    def messages(topics: Collection[str]) -> Iterator[Message]:
        with path.open("rb") as file:
            reader = SeekingReader(file, validate_crcs=True, record_size_limit=longest)
            for _, channel, message in reader.iter_messages(topics=list(topics)):
                yield channel.topic, message.log_time, message.data

    return RobotLog(path, decoders, counts, messages)
