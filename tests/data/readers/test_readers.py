"""What is written in a format is read back, to the last bit, with NaN where a sample is missing."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from pyarrow import parquet

from greybox_torch.data.readers import read_table
from greybox_torch.errors import UserError

Columns = dict[str, NDArray]


def write_csv(path: Path, columns: Columns) -> None:
    rows = zip(*columns.values(), strict=True)
    lines = [",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in rows]
    path.write_text("\n".join([",".join(columns), *lines]) + "\n")


def write_mat_v5(path: Path, columns: Columns) -> None:
    scipy.io.savemat(path, columns, do_compression=True, oned_as="column")


def write_mat_v73(path: Path, columns: Columns) -> None:
    """HDF5 behind 512 bytes of MATLAB's own, vectors as 1×N, and beside them a group for references."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in columns.items():
            file.create_dataset(name, data=values.reshape(1, -1)).attrs["MATLAB_class"] = np.bytes_(b"double")
        file.create_group("#refs#")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))


def write_npz(path: Path, columns: Columns) -> None:
    np.savez(path, allow_pickle=False, **columns)


def write_parquet(path: Path, columns: Columns) -> None:
    parquet.write_table(pa.table({name: pa.array(v, from_pandas=True) for name, v in columns.items()}), path)


WRITERS: dict[str, Callable[[Path, Columns], None]] = {
    "a.csv": write_csv,
    "v5.mat": write_mat_v5,
    "v73.mat": write_mat_v73,
    "a.npz": write_npz,
    "a.parquet": write_parquet,
}


@pytest.fixture(params=WRITERS)
def filename(request: pytest.FixtureRequest) -> str:
    return request.param


samples = st.integers(2, 30).flatmap(
    lambda n: arrays(np.float64, (2, n), elements=st.floats(width=64, allow_nan=True, allow_infinity=True))
)


@given(samples)
@pytest.mark.parametrize("name", WRITERS)
def test_round_trip_is_exact(name: str, values: NDArray) -> None:
    values[0, -1] = 1.0  # a row of two empty cells at the end of a CSV file is one comma, and stays
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        WRITERS[name](path, {"u": values[0], "other": np.zeros_like(values[0]), "y": values[1]})
        table = read_table(path, ("y", "u"))
    assert list(table.columns) == ["y", "u"]
    for column, expected in zip(("u", "y"), values, strict=True):
        assert table.columns[column].dtype == np.float64
        np.testing.assert_array_equal(table.columns[column], expected)


@pytest.mark.parametrize("dtype", ["uint8", "int32", "float32", "bool"])
def test_other_numbers_become_float64(tmp_path: Path, filename: str, dtype: str) -> None:
    values = np.array([0, 1, 1, 0]).astype(dtype)
    WRITERS[filename](tmp_path / filename, {"u": values})
    column = read_table(tmp_path / filename, ("u",)).columns["u"]
    assert column.dtype == np.float64
    assert column.tolist() == [0, 1, 1, 0]


def test_missing_column_lists_those_found_and_suggests_the_closest(tmp_path: Path, filename: str) -> None:
    WRITERS[filename](tmp_path / filename, {"Torque": np.ones(3), "speed": np.ones(3)})
    with pytest.raises(UserError) as error:
        read_table(tmp_path / filename, ("torqe",))
    message = str(error.value)
    assert message.startswith(str(tmp_path / filename))
    assert 'no column "torqe" (did you mean "Torque"?); found Torque, speed' in message


def test_damaged_file(tmp_path: Path, filename: str) -> None:
    (tmp_path / filename).write_bytes(b"\x89not what the suffix says\xff" * 40)
    with pytest.raises(UserError, match=filename):
        read_table(tmp_path / filename, ("u",))


@pytest.mark.parametrize("name", ["v5.mat", "v73.mat", "a.npz", "a.parquet"])
def test_truncated_file(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    WRITERS[name](path, {"u": np.random.default_rng(0).normal(size=500)})
    path.write_bytes(path.read_bytes()[:-1500])
    with pytest.raises(UserError, match=name):
        read_table(path, ("u",))


@pytest.mark.parametrize("name", ["v5.mat", "v73.mat", "a.npz"])
@pytest.mark.parametrize("shape", [(5,), (1, 5), (5, 1)])
def test_row_and_column_vectors(tmp_path: Path, name: str, shape: tuple[int, ...]) -> None:
    values = np.arange(5.0).reshape(shape)
    if name == "v73.mat":
        with h5py.File(tmp_path / name, "w") as file:
            file["u"] = values
    else:
        WRITERS[name](tmp_path / name, {"u": values})
    assert read_table(tmp_path / name, ("u",)).columns["u"].tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("name", ["v5.mat", "a.npz"])
def test_matrix_is_refused_with_its_shape(tmp_path: Path, name: str) -> None:
    WRITERS[name](tmp_path / name, {"u": np.ones((5, 3))})
    with pytest.raises(UserError, match=r'column "u": has the shape \(5, 3\); expected a row or column vector'):
        read_table(tmp_path / name, ("u",))


def test_scalar_in_npz_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", u=3.0)
    with pytest.raises(UserError, match=r"has the shape \(\)"):
        read_table(tmp_path / "a.npz", ("u",))


@pytest.mark.parametrize(
    ("value", "what"),
    [
        (np.array(["a", "b"]), "text"),
        (np.array([1j, 2j]), "complex numbers"),
        (np.array([object()]), "Object arrays"),
    ],
)
def test_npz_of_other_kinds_is_refused(tmp_path: Path, value: NDArray, what: str) -> None:
    np.savez(tmp_path / "a.npz", u=value)
    with pytest.raises(UserError, match=f'column "u".*{what}'):
        read_table(tmp_path / "a.npz", ("u",))


def cells() -> NDArray:
    content = np.empty(2, dtype=object)
    content[:] = [np.ones(1), np.ones(2)]
    return content


@pytest.mark.parametrize(
    ("value", "what"),
    [
        ("abc", "text"),
        (np.array([1j, 2j]), "complex numbers"),
        ({"field": 1.0}, "a structure"),
        (cells(), "cells or objects"),
    ],
)
def test_mat_v5_of_other_kinds_is_refused(tmp_path: Path, value: object, what: str) -> None:
    scipy.io.savemat(tmp_path / "a.mat", {"u": value})
    with pytest.raises(UserError, match=f'column "u": holds {what}; expected real numbers'):
        read_table(tmp_path / "a.mat", ("u",))


def test_mat_v73_of_other_kinds_is_refused(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.mat", "w") as file:
        file.create_dataset("text", data=np.array([[97], [98]], dtype=np.uint16)).attrs["MATLAB_class"] = np.bytes_(
            "char"
        )
        file.create_group("struct")
    for column, what in [("text", "text"), ("struct", "a structure")]:
        with pytest.raises(UserError, match=f'column "{column}": holds {what}; expected real numbers'):
            read_table(tmp_path / "a.mat", (column,))


def test_mat_v73_empty_array_has_no_samples(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.mat", "w") as file:
        empty = file.create_dataset("u", data=np.array([0, 0], dtype=np.uint64))
        empty.attrs["MATLAB_class"] = np.bytes_("double")
        empty.attrs["MATLAB_empty"] = 1
    assert len(read_table(tmp_path / "a.mat", ("u",)).columns["u"]) == 0


def test_parquet_of_text_is_refused(tmp_path: Path) -> None:
    parquet.write_table(pa.table({"u": ["1", "2"]}), tmp_path / "a.parquet")
    with pytest.raises(UserError, match='column "u": holds string; expected real numbers'):
        read_table(tmp_path / "a.parquet", ("u",))


def test_parquet_column_with_a_dot_in_its_name(tmp_path: Path) -> None:
    write_parquet(tmp_path / "a.parquet", {"motor.u": np.array([1.0, np.nan])})
    np.testing.assert_array_equal(read_table(tmp_path / "a.parquet", ("motor.u",)).columns["motor.u"], [1, np.nan])


def test_unknown_suffix_lists_the_known(tmp_path: Path) -> None:
    with pytest.raises(
        UserError, match=r'no reader for files ending in ".xlsx"; expected one of .csv, .mat.*; save the sheet as CSV'
    ):
        read_table(tmp_path / "a.xlsx", ("u",))


@pytest.mark.parametrize("first", [b"PK\x03\x04\x14\x00", b"\xd0\xcf\x11\xe0\xa1\xb1"])
def test_a_workbook_named_as_text(tmp_path: Path, first: bytes) -> None:
    """Seen: its bytes, as the names of the columns that were found."""
    (tmp_path / "a.csv").write_bytes(first + b"[Content_Types],\nxl")
    with pytest.raises(UserError, match=r"a.csv: is an .*Excel file.*; save the sheet as CSV"):
        read_table(tmp_path / "a.csv", ("u",))


def test_suffix_in_capitals(tmp_path: Path) -> None:
    write_csv(tmp_path / "A.CSV", {"u": np.ones(2)})
    assert read_table(tmp_path / "A.CSV", ("u",)).columns["u"].tolist() == [1, 1]


def test_missing_file_suggests_the_closest(tmp_path: Path) -> None:
    (tmp_path / "estimation.csv").touch()
    with pytest.raises(UserError, match=r'estimaton.csv: no such file \(did you mean "estimation.csv"\?\)'):
        read_table(tmp_path / "estimaton.csv", ("u",))


def test_folder_in_place_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "a.csv").mkdir()
    with pytest.raises(UserError, match=r"a.csv: is a folder"):
        read_table(tmp_path / "a.csv", ("u",))
