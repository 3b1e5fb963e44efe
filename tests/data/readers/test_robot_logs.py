"""Logs of robots, written by other people's writers: bags of ROS 2 in SQLite and MCAP by rosbags, JSON in MCAP by mcap."""

from __future__ import annotations

import json
import sqlite3
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from greybox_torch.data import load_dataset
from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers import read_table
from greybox_torch.errors import UserError

START = 1_700_000_000_000_000_000
LINK = "float64 torque\nfloat64[3] axis\nstring note\n"
SUFFIX = {StoragePlugin.SQLITE3: ".db3", StoragePlugin.MCAP: ".mcap"}


def a_bag(folder: Path, storage: StoragePlugin) -> Path:
    """50 joint states at 100 Hz by their headers, recorded 3 ms late, and 20 commands of an own type at 50 Hz that have no header."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(LINK, "bench_msgs/msg/Link"))
    types: Any = store.types
    with Writer(folder / "bag", version=9, storage_plugin=storage) as bag:
        state = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        link = bag.add_connection("/link", "bench_msgs/msg/Link", typestore=store)
        for k in range(50):
            stamp = types["builtin_interfaces/msg/Time"](sec=1_700_000_000, nanosec=10_000_000 * k)
            header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
            joints = types["sensor_msgs/msg/JointState"](
                header=header,
                name=["a", "b"],
                position=np.array([0.1 * k, 2.0]),
                velocity=np.array([k**2, 0.0]),
                effort=np.array([]),
            )
            recorded = START + 10_000_000 * k + 3_000_000
            bag.write(state, recorded, store.serialize_cdr(joints, "sensor_msgs/msg/JointState"))
        for k in range(25):
            message = types["bench_msgs/msg/Link"](torque=float(k), axis=np.array([k, 1.0, 2.0]), note="on")
            bag.write(link, START + 20_000_000 * k, store.serialize_cdr(message, "bench_msgs/msg/Link"))
    (file,) = (folder / "bag").glob(f"*{SUFFIX[storage]}")
    return file


@pytest.fixture(params=SUFFIX, ids=SUFFIX.values(), scope="module")
def bag(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return a_bag(tmp_path_factory.mktemp("robot"), request.param)


def test_fields_of_one_topic(bag: Path) -> None:
    table = read_table(bag, ["/joint_states.time", "/joint_states.position[0]", "/joint_states.velocity[0]"])
    k = np.arange(50)
    assert table.columns["/joint_states.time"] == pytest.approx(1.7e9 + 0.01 * k, abs=1e-6)  # of the header
    assert table.columns["/joint_states.position[0]"] == pytest.approx(0.1 * k)
    assert table.columns["/joint_states.velocity[0]"] == pytest.approx(k**2)
    assert table.notes == ()


def test_a_topic_without_header_has_the_times_of_recording(bag: Path) -> None:
    table = read_table(bag, ["/link.time", "/link.axis[0]"])
    assert table.columns["/link.time"] == pytest.approx(1.7e9 + 0.02 * np.arange(25), abs=1e-6)
    assert table.columns["/link.axis[0]"] == pytest.approx(np.arange(25))


def test_another_topic_is_brought_to_the_times_of_the_clock(bag: Path) -> None:
    table = read_table(bag, ["/link.torque", "/joint_states.time", "/joint_states.position[0]"])
    torque = table.columns["/link.torque"]
    assert torque[:49] == pytest.approx(0.5 * np.arange(49), abs=1e-4) and np.isnan(torque[49])
    assert len(table.notes) == 1 and '"/link.torque" is brought to the times of /joint_states' in table.notes[0]


def test_a_card_with_a_bag(bag: Path) -> None:
    card = bag.parent / "dataset.toml"
    card.write_text(
        'time = "/joint_states.time"\n[channels]\ntorque = { column = "/link.torque", unit = "N m" }\n'
        f'q = {{ column = "/joint_states.position[0]", unit = "rad" }}\n[[experiment]]\nname = "run"\nfile = "{bag.name}"\n'
        "rows = [0, 49]\n"
    )
    recording = load_dataset(card).recordings[0]
    assert recording.sample_time == pytest.approx(0.01, rel=1e-4)
    assert any("brought to the times" in note for note in recording.notes)


def test_what_there_is_is_listed(bag: Path) -> None:
    names = columns_of(bag).names
    assert names[0] == "/joint_states.time"  # of the topic with most messages
    assert set(names[1:]) == {
        *(f"/joint_states.{field}[{k}]" for field in ("position", "velocity") for k in (0, 1)),
        *("/link.time", "/link.torque", "/link.axis[0]", "/link.axis[1]", "/link.axis[2]"),
    }


@pytest.mark.parametrize(
    ("column", "message"),
    [
        (
            "/joint_state.position[0]",
            r'no column "/joint_state", did you mean "/joint_states"|no column "/joint_state"',
        ),
        ("/joint_states.speed", 'the messages have no field "speed"'),
        (
            "/joint_states.position",
            r'holds no single number; expected a number, such as one element "/joint_states.position\[0\]"',
        ),
        ("/joint_states.position[7]", "no message has as many elements"),
        ("/link.note", "holds text"),
        ("/link.torque[0]", "has no elements"),
        ("/link", r'expected a field of the topic, like "/link.position\[0\]", or "/link.time"'),
    ],
)
def test_what_is_not_there(bag: Path, column: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        read_table(bag, [column])


def test_the_folder_of_a_bag_is_told_apart(bag: Path) -> None:
    card = bag.parent.parent / "dataset.toml"
    card.write_text(
        'sample_time = 1.0\n[channels]\nq = { column = "q" }\n[[experiment]]\nname = "run"\nfile = "bag.mcap"\n'
    )
    (bag.parent.parent / "bag.mcap").symlink_to(bag.parent)
    with pytest.raises(
        UserError, match=rf"bag.mcap: is a folder; expected a recording, such as bag.mcap/{bag.name} in it"
    ):
        load_dataset(card)


def test_a_damaged_bag(bag: Path, tmp_path: Path) -> None:
    cut = tmp_path / f"cut{bag.suffix}"
    cut.write_bytes(bag.read_bytes()[: bag.stat().st_size // 2])
    with pytest.raises(UserError, match=r"cut\.(db3|mcap): "):
        read_table(cut, ["/link.torque"])


def test_a_bag_that_is_still_open(tmp_path: Path) -> None:
    """Seen: of a bag whose recorder was killed, the messages that SQLite had not moved into the file yet were left out without a word."""
    file = a_bag(tmp_path, StoragePlugin.SQLITE3)
    with closing(sqlite3.connect(file)) as recorder:
        recorder.execute("PRAGMA journal_mode = WAL")
        recorder.execute("DELETE FROM messages WHERE id > 60")
        recorder.commit()
        beside = (
            rf"{file.name}: messages are still in {file.name}-wal beside it; expected a bag that was closed \(sqlite3 "
        )
        for read in (columns_of, lambda path: read_table(path, ["/link.torque"])):
            with pytest.raises(UserError, match=beside):
                read(file)
    assert len(read_table(file, ["/link.torque"]).columns["/link.torque"]) == 10


def test_json_in_mcap(tmp_path: Path) -> None:
    file = tmp_path / "log.mcap"
    with file.open("wb") as out:
        writer = McapWriter(out)
        writer.start()
        schema = writer.register_schema("drive", "jsonschema", b'{"type": "object"}')
        channel = writer.register_channel("drive", "json", schema)
        other = writer.register_channel("camera", "protobuf", schema)
        for k in range(12):
            stamp = START + 1_000_000 * k
            data = json.dumps({"motor": {"i": 0.5 * k}, "mode": "on"}).encode()
            writer.add_message(channel, stamp, data, stamp)
        writer.add_message(other, START, b"\0", START)
        writer.finish()
    table = read_table(file, ["drive.time", "drive.motor.i"])
    assert table.columns["drive.motor.i"] == pytest.approx(0.5 * np.arange(12))
    assert columns_of(file).names == ("drive.time", "drive.motor.i")
    with pytest.raises(
        UserError, match='topic "camera" has messages in the encoding "protobuf"; expected cdr, ros1 or json'
    ):
        read_table(file, ["camera.x"])


def test_a_type_that_nobody_defines(tmp_path: Path) -> None:
    """Bags of releases before Iron define no types: those of ROS are known, others are not."""
    file = a_bag(tmp_path, StoragePlugin.SQLITE3)
    bag = sqlite3.connect(file)
    bag.execute("DROP TABLE message_definitions")
    bag.commit()
    bag.close()
    assert len(read_table(file, ["/joint_states.position[1]"]).columns["/joint_states.position[1]"]) == 50
    with pytest.raises(UserError, match='the log does not define its type "bench_msgs/msg/Link"'):
        read_table(file, ["/link.torque"])


@pytest.mark.parametrize("package", ["mcap.reader", "rosbags.typesys"])
def test_without_the_packages(package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = a_bag(tmp_path, StoragePlugin.MCAP)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(UserError, match=r"need a package more; install it by pip install 'greybox_torch\[robot\]'"):
        read_table(file, ["/link.torque"])
