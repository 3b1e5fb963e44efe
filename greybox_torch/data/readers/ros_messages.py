"""How messages of a topic are decoded: those of ROS by their definition, and those in JSON."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from greybox_torch.errors import UserError

NEEDED = "pip install 'greybox_torch[robot]'"


@dataclass(frozen=True)
class Decoder:
    """Decodes the messages of one topic. What that needs is made at the first, as most topics of a log are never asked for.

    ``kind`` is their type, such as "sensor_msgs/msg/JointState"; ``encoding`` is "cdr" (ROS 2), "ros1" or "json"; ``definition`` is of the
    type in ``language`` ("ros2msg", "ros2idl", "ros1msg"), empty where the log has none: then it is one of ROS itself.
    """

    path: Path
    topic: str
    kind: str
    encoding: str
    definition: str = ""
    language: str = ""

    def __call__(self, raw: bytes) -> Any:
        """The message. Raises UserError where the type is not known, the encoding is another, or a package is not installed."""
        return self._decode(raw)

    @cached_property
    def _decode(self) -> Callable[[bytes], Any]:
        if self.encoding == "json":
            return json.loads
        if self.encoding not in ("cdr", "ros1"):
            raise UserError(
                f'{self.path}: topic "{self.topic}" has messages in the encoding "{self.encoding}"; expected cdr, ros1 or json'
            )
        name = self.kind if self.kind.count("/") == 2 else self.kind.replace("/", "/msg/", 1)
        store = self._types(name)
        if name not in store.fielddefs:
            raise UserError(
                f'{self.path}: topic "{self.topic}": the log does not define its type "{self.kind}"; '
                "expected a log that does, such as one in MCAP"
            )
        read = store.deserialize_cdr if self.encoding == "cdr" else store.deserialize_ros1
        return lambda raw: read(raw, name)

    def _types(self, name: str) -> Any:
        try:
            from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
        except ImportError:
            raise UserError(f"{self.path}: messages of ROS need a package more; install it by {NEEDED}") from None
        if not self.definition:
            return get_typestore(Stores.LATEST)
        store = get_typestore(Stores.EMPTY)
        of_idl = self.language == "ros2idl"
        store.register(get_types_from_idl(self.definition) if of_idl else get_types_from_msg(self.definition, name))
        return store
