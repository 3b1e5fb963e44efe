"""Files that are not what they seem: one message, at once, and nothing allocated for what they declare."""

from __future__ import annotations

import os
import struct
import tracemalloc
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pytest
import scipy.io
from pyarrow import parquet

from greybox_torch.data.readers import READERS, read_table
from greybox_torch.errors import UserError


@pytest.fixture
def little_memory() -> Iterator[None]:
    """No fault below may take more than 64 MiB."""
    tracemalloc.start()
    yield
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 64 * 2**20


def npy(shape: str, kind: str = "<f8", data: bytes = b"") -> bytes:
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(118) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + data


def archive(path: Path, content: bytes, method: int = zipfile.ZIP_STORED) -> Path:
    with zipfile.ZipFile(path, "w", method) as file:
        file.writestr("u.npy", content)
    return path


def refused(path: Path, message: str) -> None:
    with pytest.raises(UserError, match=message) as error:
        read_table(path, ("u",))
    assert path.name in str(error.value)


@pytest.mark.parametrize("suffix", [".csv", ".mat", ".npz", ".h5", ".parquet", ".json"])
def test_a_file_of_no_bytes(tmp_path: Path, suffix: str) -> None:
    """Seen: a log that was never written, told as a column that the card has wrong."""
    (tmp_path / f"a{suffix}").touch()
    refused(tmp_path / f"a{suffix}", r"is empty \(0 bytes\); expected a recording$")


@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize(
    "shape", ["(100000000000,)", f"({10**40},)", "(100000, 100000)", "(-5,)", "(2.5,)", "(None,)", "(10,"]
)
def test_archive_that_declares_more_than_it_holds(tmp_path: Path, shape: str) -> None:
    refused(archive(tmp_path / "a.npz", npy(shape, data=bytes(80))), 'column "u"|cannot be read as .npz: TokenError')


@pytest.mark.usefixtures("little_memory")
def test_archive_bomb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It declares what it holds, and is refused for its size alone."""
    monkeypatch.setattr("greybox_torch.data.readers.table.MOST_SAMPLES", 10_000_000)
    path, unpacked = tmp_path / "a.npz", 11_000_000 * 8
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file, file.open("u.npy", "w") as member:
        member.write(npy(f"({unpacked // 8},)"))
        for _ in range(11):
            member.write(bytes(unpacked // 11))
    refused(path, r"declares 1.1e\+07 samples")


def test_archives_of_other_kinds(tmp_path: Path) -> None:
    (tmp_path / "empty.npz").write_bytes(b"PK\x05\x06" + bytes(18))
    refused(tmp_path / "empty.npz", 'no column "u"; found none')
    refused(archive(tmp_path / "text.npz", b"text"), "magic string")
    refused(archive(tmp_path / "object.npz", npy("(3,)", "|O", bytes(24))), "Object arrays")
    refused(
        archive(tmp_path / "bzip.npz", npy("(3,)", data=bytes(10)), zipfile.ZIP_BZIP2),
        "declares 3 samples|cannot be read",
    )
    path = archive(tmp_path / "locked.npz", npy("(3,)", data=bytes(24)))
    content = bytearray(path.read_bytes())
    content[6] |= 1
    content[content.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(content)
    refused(path, "encrypted")
    content[6] &= 0xFE
    content[content.index(b"PK\x01\x02") + 8] &= 0xFE
    content[8] = content[content.index(b"PK\x01\x02") + 10] = 99
    path.write_bytes(content)
    refused(path, "compression method is not supported|cannot be read")


def h5(path: Path) -> h5py.File:
    return h5py.File(path, "w")


def test_hdf5_that_leads_elsewhere(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    with h5(tmp_path / "other.h5") as file:
        file["u"] = np.ones(5)
    for link, message in [
        (h5py.ExternalLink("other.h5", "/u"), "is a link into another file"),
        (h5py.SoftLink("/nowhere"), "is a link to nothing"),
        (h5py.SoftLink("/u"), "is a link to nothing|cannot be read"),
    ]:
        with h5(path) as file:
            file["u"] = link
        refused(path, message)
    with h5(path) as file:
        layout = h5py.VirtualLayout(shape=(5,), dtype="f8")
        layout[:] = h5py.VirtualSource("other.h5", "u", shape=(5,))
        file.create_virtual_dataset("u", layout)
    refused(path, "its numbers stand in other files")
    with h5(path) as file:
        file.create_dataset("u", shape=(5,), dtype="f8", external=[("other.bin", 0, 40)])
    refused(path, "its numbers stand in other files")


@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize("shape", [(10**11,), (10**6, 10**6), (10**18,)])
def test_hdf5_that_declares_more_than_it_holds(tmp_path: Path, shape: tuple[int, ...]) -> None:
    with h5(tmp_path / "a.mat") as file:
        file.create_dataset("u", shape=shape, dtype="f8", chunks=(1000,) * len(shape))
    refused(tmp_path / "a.mat", "declares .* samples")


@pytest.mark.parametrize(
    "packed",
    [
        {"scaleoffset": 0},
        {"scaleoffset": 0, "compression": "gzip"},
        {"compression": "lzf"},
        {"shuffle": True, "fletcher32": True},
    ],
)
def test_hdf5_that_holds_more_than_its_bytes(tmp_path: Path, packed: dict[str, int | str]) -> None:
    """Seen: a sound dataset behind a filter that is no compression to h5py was "damaged"."""
    with h5(tmp_path / "a.h5") as file:
        file.create_dataset("u", data=np.full(100_000, 3), **packed)
    np.testing.assert_array_equal(read_table(tmp_path / "a.h5", ("u",)).columns["u"], np.full(100_000, 3.0))


def test_hdf5_of_other_kinds(tmp_path: Path) -> None:
    with h5(tmp_path / "a.h5") as file:
        file["u"] = h5py.Empty("f8")
    refused(tmp_path / "a.h5", "holds nothing")
    with h5(tmp_path / "b.h5") as file:
        file["u"] = np.zeros(5, dtype=[("a", "f8"), ("b", "f8")])
    refused(tmp_path / "b.h5", "holds a structure")
    with h5(tmp_path / "c.h5") as file:
        file["u"] = ["one", "two"]
    refused(tmp_path / "c.h5", "holds cells or objects")
    with h5(tmp_path / "d.h5") as file:
        file["u"] = np.ones(5) * 1j
    refused(tmp_path / "d.h5", "complex")


def element(kind: int, data: bytes, length: int | None = None) -> bytes:
    return struct.pack("<II", kind, len(data) if length is None else length) + data + b"\0" * (-len(data) % 8)


def mat(*elements: bytes) -> bytes:
    return b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + b"".join(elements)


def matrix(dimensions: tuple[int, ...], kind: int = 6, length: int | None = None) -> bytes:
    inner = element(6, struct.pack("<II", kind, 0)) + element(5, struct.pack(f"<{len(dimensions)}i", *dimensions))
    return inner + element(1, b"u") + element(9, bytes(40), length)


@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize(
    "content",
    [
        mat(element(14, matrix((10**9, 100)))),
        mat(element(14, matrix((2**31 - 1, 2**31 - 1)))),
        mat(element(14, matrix((5, 1)), length=2**32 - 8)),
        mat(element(14, matrix((5, 1), length=2**32 - 8))),
        mat(element(14, matrix((10**9, 1), kind=1))),
        mat(element(15, zlib.compress(element(14, matrix((10**9, 100)))))),
        mat(element(15, zlib.compress(element(14, matrix((5, 1)), length=2**32 - 8)))),
        mat(element(15, b"not compressed at all")),
        mat(element(14, b"")),
        mat(element(14, bytes(100))),
        mat(),
        mat() + b"\x0e",
        b"MATLAB 5.0",
        b"",
    ],
)
def test_matlab_that_declares_more_than_it_holds(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.mat").write_bytes(content)
    refused(tmp_path / "a.mat", r"declares|cannot be read as|no column")


def test_matlab_with_a_bit_that_fell_over(tmp_path: Path) -> None:
    """Seen: 23 of 300 such files were read as other numbers, as the checksum behind them was never looked at."""
    values = np.random.default_rng(0).normal(size=500)
    scipy.io.savemat(tmp_path / "a.mat", {"u": values}, do_compression=True)
    sound = (tmp_path / "a.mat").read_bytes()
    np.testing.assert_array_equal(read_table(tmp_path / "a.mat", ("u",)).columns["u"], values)
    for place in range(300, len(sound), 37):
        (tmp_path / "a.mat").write_bytes(sound[:place] + bytes([sound[place] ^ 0x10]) + sound[place + 1 :])
        refused(tmp_path / "a.mat", "cannot be read|declares|unpacks|no column")


def test_matlab_that_unpacks_to_more_than_it_declares(tmp_path: Path) -> None:
    packed = zlib.compress(element(14, matrix((5, 1))) + bytes(8))
    (tmp_path / "a.mat").write_bytes(mat(element(15, packed, len(packed))))
    refused(tmp_path / "a.mat", "unpacks to another length than it declares")


def test_parquet_with_a_column_twice(tmp_path: Path) -> None:
    parquet.write_table(
        pa.Table.from_arrays([pa.array([1.0]), pa.array([2.0])], names=["u", "u"]), tmp_path / "a.parquet"
    )
    refused(tmp_path / "a.parquet", '2 columns are named "u"')


def test_parquet_dates_are_seconds_since_1970(tmp_path: Path) -> None:
    """As in all other formats. Seen: files that began at different times were joined as if at the same one."""
    stamps = np.datetime64("2026-11-21T08:00:00", "ms") + np.arange(4) * np.timedelta64(250, "ms")
    since = [np.nan, *(stamps.astype(float)[1:] / 1000.0)]
    stamps[0] = "NaT"
    columns = {"u": pa.array(stamps), "v": pa.array(stamps).cast(pa.timestamp("ms", tz="Europe/Berlin"))}
    parquet.write_table(pa.table(columns), tmp_path / "a.parquet")
    for values in read_table(tmp_path / "a.parquet", ("u", "v")).columns.values():
        np.testing.assert_allclose(values, since, rtol=0, atol=1e-6)


@pytest.mark.parametrize("suffix", READERS)
def test_what_is_no_file(tmp_path: Path, suffix: str) -> None:
    os.mkfifo(tmp_path / f"pipe{suffix}")
    refused(tmp_path / f"pipe{suffix}", "is a pipe; expected a recording, in a regular file")
    (tmp_path / f"zero{suffix}").symlink_to("/dev/zero")
    refused(tmp_path / f"zero{suffix}", "is a device")
    (tmp_path / f"empty{suffix}").touch()
    refused(tmp_path / f"empty{suffix}", "empty")
    with pytest.raises(UserError, match="File name too long"):
        read_table(tmp_path / ("x" * 300 + suffix), ("u",))
    with pytest.raises(UserError, match="cannot be the name of a file"):
        read_table(tmp_path / f"a\0b{suffix}", ("u",))
