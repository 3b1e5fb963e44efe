"""Columns inside structures, cells, groups and matrices; JSON; and MATLAB files with an object of a class beside the numbers."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io

from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers import read_table
from greybox_torch.errors import UserError

U, Y = np.arange(5.0), np.array([1.0, np.nan, 3.0, 4.0, 5.0])


def cells(*content: Any) -> np.ndarray:
    made = np.empty(len(content), dtype=object)
    made[:] = content
    return made


def mat_v5(folder: Path) -> Path:
    log = {"motor": {"u": U, "Y": np.column_stack([U, Y])}, "runs": cells({"u": U}, {"u": Y})}
    scipy.io.savemat(folder / "a.mat", {"log": log, "M": np.column_stack([U, Y]), "u": U}, do_compression=True)
    return folder / "a.mat"


def mat_v73(folder: Path) -> Path:
    """As MATLAB writes it: matrices transposed, structures as groups, cells as references."""
    with h5py.File(folder / "b.mat", "w") as file:
        file["M"] = np.column_stack([U, Y]).T
        file["log/motor/u"] = U[None]
        file["log/motor/Y"] = np.column_stack([U, Y]).T
        file["#refs#/a/u"], file["#refs#/b/u"] = U[None], Y[None]
        runs = file.create_dataset("log/runs", (2, 1), dtype=h5py.ref_dtype)
        runs[:, 0] = [file["#refs#/a"].ref, file["#refs#/b"].ref]
        runs.attrs["MATLAB_class"] = np.bytes_("cell")
    return folder / "b.mat"


def hdf5(folder: Path) -> Path:
    with h5py.File(folder / "c.h5", "w") as file:
        file["M"], file["log/motor/u"], file["log/motor/Y"] = np.column_stack([U, Y]), U, np.column_stack([U, Y])
        file.create_dataset("zeros", data=np.zeros(100_000), compression="gzip")
    return folder / "c.h5"


def json_of_arrays(folder: Path) -> Path:
    y = [None if np.isnan(v) else v for v in Y]
    content = {
        "log": {
            "motor": {"u": U.tolist(), "Y": [[a, b] for a, b in zip(U, Y, strict=True)]},
            "runs": [{"u": 1}, {"u": y}],
        },
        "M": [[a, b] for a, b in zip(U, Y, strict=True)],
    }
    (folder / "d.json").write_text(json.dumps(content))
    return folder / "d.json"


@pytest.mark.parametrize("make", [mat_v5, mat_v73, hdf5, json_of_arrays])
def test_fields_and_columns_of_matrices(tmp_path: Path, make: Any) -> None:
    path = make(tmp_path)
    found = read_table(path, ("log.motor.u", "log.motor.Y[:, 1]", "M[:,1]")).columns
    np.testing.assert_array_equal(found["log.motor.u"], U)
    np.testing.assert_array_equal(found["log.motor.Y[:, 1]"], Y)
    np.testing.assert_array_equal(found["M[:,1]"], Y)
    for column, message in [
        ("log.motr.u", "motr"),
        ("log.motor.v", "v"),
        ("M[:, 2]", r"2 is not among its 2 columns; the first is 0"),
        (
            "M",
            r"shape \(5, 2\); expected a row or column vector; one column of a matrix is written \"M\[:, 0\]\"|found \[0.0, 1.0\]",
        ),
        ("log", "found|holds"),
        ("nothing.u", 'no column "nothing.u"'),
        ("M[", 'no column "M\\["'),
        ("log..u", "no column|a name is missing"),
        ("M.x", "M.x"),
    ]:
        with pytest.raises(UserError, match=message) as error:
            read_table(path, (column,))
        assert str(error.value).startswith(str(path))


@pytest.mark.parametrize("make", [mat_v5, mat_v73, json_of_arrays])
def test_elements(tmp_path: Path, make: Any) -> None:
    path = make(tmp_path)
    np.testing.assert_array_equal(read_table(path, ("log.runs[1].u",)).columns["log.runs[1].u"], Y)
    with pytest.raises(UserError, match=r"\[2\] is not among its 2 elements; the first is \[0\]"):
        read_table(path, ("log.runs[2].u",))


def test_slashes_lead_into_groups_of_hdf5(tmp_path: Path) -> None:
    np.testing.assert_array_equal(read_table(hdf5(tmp_path), ("log/motor/u",)).columns["log/motor/u"], U)
    assert read_table(hdf5(tmp_path), ("zeros",)).columns["zeros"].size == 100_000


def test_matrix_in_an_archive(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "a.npz", Y=np.column_stack([U, Y]), **{"a.b": U})
    found = read_table(tmp_path / "a.npz", ("Y[:, 1]", "a.b")).columns
    np.testing.assert_array_equal(found["Y[:, 1]"], Y)
    np.testing.assert_array_equal(found["a.b"], U)


def opaque(name: bytes) -> bytes:
    """A variable of a class of MATLAB's own (a table, a string, a timeseries): its content stands elsewhere in the file."""

    def element(kind: int, data: bytes) -> bytes:
        return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    inner = element(6, struct.pack("<II", 17, 0)) + element(1, name) + element(1, b"MCOS") + element(1, b"timeseries")
    content = element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 6, 1)) + element(1, b"")
    content += element(6, struct.pack("<6I", 0xDD000000, 2, 1, 1, 1, 1))
    return element(14, inner + element(14, content))


def test_an_object_beside_the_numbers_is_left_alone(tmp_path: Path) -> None:
    path = mat_v5(tmp_path)
    content = path.read_bytes()
    path.write_bytes(content[:128] + opaque(b"ts") + content[128:])
    np.testing.assert_array_equal(read_table(path, ("u", "log.motor.u")).columns["u"], U)
    with pytest.raises(UserError, match='no column "v"; found ts, log, M, u'):
        read_table(path, ("v",))
    with pytest.raises(UserError, match='column "ts": holds an object'):
        read_table(path, ("ts",))


RECORDS = [
    {"t": 0.1 * k, "motor": {"u": u, "w": [0.0, u]}, "y": None if np.isnan(y) else y}
    for k, (u, y) in enumerate(zip(U, Y, strict=True))
]


@pytest.mark.parametrize("name", ["a.json", "a.jsonl", "a.ndjson"])
def test_records(tmp_path: Path, name: str) -> None:
    lines = [json.dumps(record) for record in RECORDS]
    (tmp_path / name).write_text("[" + ",\n".join(lines) + "]" if name == "a.json" else "\n\n".join(lines) + "\n")
    table = read_table(tmp_path / name, ("motor.u", "y", "motor.w[1]"))
    np.testing.assert_array_equal(table.columns["motor.u"], U)
    np.testing.assert_array_equal(table.columns["motor.w[1]"], U)
    np.testing.assert_array_equal(table.columns["y"], Y)
    with pytest.raises(UserError, match=r'no record has "motor\.v"; found t, motor, y'):
        read_table(tmp_path / name, ("motor.v",))
    with pytest.raises(UserError, match='no column "z"; found t, motor, y'):
        read_table(tmp_path / name, ("z",))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_separators_of_unicode_end_no_line(tmp_path: Path, end: str) -> None:
    """Seen: a log with a line separator in a note was "not JSON: Unterminated string"."""
    lines = [json.dumps({"u": u, "note": "one\u2028two\x85three"}, ensure_ascii=False) for u in U]
    (tmp_path / "a.jsonl").write_text(end.join(lines), encoding="utf-8", newline="")
    np.testing.assert_array_equal(read_table(tmp_path / "a.jsonl", ("u",)).columns["u"], U)
    assert columns_of(tmp_path / "a.jsonl").names == ("u",)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.json", " ", "not JSON"),
        ("a.json", "[" * 100_000, "not JSON: nested too deeply"),
        ("a.json", "3", "holds neither an object nor a list"),
        ("a.json", "[1, 2]", "entry 0 .*: found 1, expected a record"),
        ("a.json", '{"u": 3}', 'column "u": found 3, expected a list of numbers'),
        ("a.json", '{"u": [1, "2"]}', 'sample 1 .*: found "2", expected a number'),
        ("a.json", '{"u": [1, ' + "9" * 400 + "]}", "a number of very many digits"),
        ("a.json", '{"u": [1, ' + "9" * 5000 + "]}", "not JSON: Exceeds the limit"),
        ("a.json", '{"u": [[1, 2], [3]]}', "sample 0"),
        ("a.jsonl", '{"u": 1}\n{"u": 2\n', "line 2: not JSON"),
        ("a.jsonl", '{"u": 1}\n\n[2]\n', r"line 3: found \[2\], expected a record"),
        ("a.jsonl", '{"u": 1}\n\n{"u": {}}\n', r'column "u", line 3, sample 1 .*: found {}'),
    ],
)
def test_json_that_cannot_be_read(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(UserError, match=message):
        read_table(tmp_path / name, ("u",))
