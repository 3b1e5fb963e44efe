"""Files of every format, damaged at random: each is a table or one message, and nothing else."""

from __future__ import annotations

import os
import random
import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from greybox_torch.data.readers import read_table
from greybox_torch.errors import UserError


def sound_files() -> dict[str, bytes]:
    """A small sound file of every format, to damage."""
    u = np.arange(30.0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "a.csv").write_text("u;v\n" + "".join(f"{v:g};1\n" for v in u))
        (folder / "a.json").write_text('{"u": [' + ", ".join(f"{v:g}" for v in u) + "]}")
        (folder / "a.jsonl").write_text("".join(f'{{"u": {v:g}}}\n' for v in u))
        np.savez_compressed(folder / "a.npz", u=u)
        np.savez(folder / "b.npz", u=u)
        scipy.io.savemat(folder / "a.mat", {"s": {"x": 1.0}, "u": u}, do_compression=True)
        scipy.io.savemat(folder / "b.mat", {"s": {"x": 1.0}, "u": u})
        scipy.io.savemat(folder / "c.mat", {"u": u}, format="4")
        parquet.write_table(pa.table({"u": u}), folder / "a.parquet")
        with h5py.File(folder / "a.h5", "w") as file:
            file["u"] = u
        with h5py.File(folder / "d.mat", "w") as file:
            file.create_dataset("u", data=u, compression="gzip").attrs["MATLAB_class"] = np.bytes_("double")
        for storage in StoragePlugin:
            robot_log(folder / storage.name, storage)
        for k, bag in enumerate(sorted(folder.glob("*/*.*"))):
            if bag.suffix in (".db3", ".mcap"):
                bag.rename(folder / f"{k}{bag.suffix}")
        return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def robot_log(folder: Path, storage: StoragePlugin) -> None:
    """A bag of ROS with 30 numbers in the topic `u`."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    number: Any = store.types["std_msgs/msg/Float64"]
    with Writer(folder, version=9, storage_plugin=storage) as bag:
        topic = bag.add_connection("u", "std_msgs/msg/Float64", typestore=store)
        for k in range(30):
            bag.write(topic, k * 10**7, store.serialize_cdr(number(data=float(k)), "std_msgs/msg/Float64"))


SOUND = sound_files()


@pytest.fixture(scope="module")
def fast_folder() -> Iterator[Path]:
    """A folder in memory where there is one: writing thousands of files to a disk takes longer than reading them."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as folder:
        yield Path(folder)


def damaged(content: bytes, draw: random.Random) -> bytes:
    """The content with one to four bytes, lengths or ends of it changed."""
    held = bytearray(content)
    for _ in range(draw.randint(1, 4)):
        place = draw.randrange(len(held) + 1)
        match draw.randrange(4):
            case 0:
                held[place : place + 1] = draw.randbytes(draw.randrange(3))
            case 1 if draw.random() < 0.2:
                del held[place:]
            case 2:
                held[place : place + 4] = struct.pack("<i", draw.choice([-1, 0, 1, 2**31 - 1, draw.randrange(2**31)]))
            case _:
                held[place:place] = draw.randbytes(draw.randint(1, 20))
    return bytes(held)


@given(seed=st.integers(0, 2**32), name=st.sampled_from(sorted(SOUND)))
@settings(max_examples=300, suppress_health_check=list(HealthCheck))
def test_damage_of_any_kind_is_told_or_harmless(fast_folder: Path, seed: int, name: str) -> None:
    """Twenty damaged files an example."""
    draw, path = random.Random(seed), fast_folder / name
    for _ in range(20):
        path.write_bytes(damaged(SOUND[name], draw))
        try:
            column = "u.data" if path.suffix in (".db3", ".mcap") else "u"
            found = read_table(path, (column,)).columns[column]
        except UserError as error:
            assert str(error).startswith(str(path))
            assert "\n" not in str(error)
        else:
            assert found.dtype == np.float64
            assert found.ndim == 1
