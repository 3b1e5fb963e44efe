"""The columns of files of every format are listed by the names that their readers know them by."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io

from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers import BUILT_IN, read_table, register_reader, unregister_reader
from greybox_torch.errors import UserError

U, Y = np.linspace(0.0, 1.0, 12), np.arange(24.0).reshape(12, 2)


def text(content: str) -> Callable[[Path], None]:
    return lambda path: path.write_text(content) and None


def numbers(delimiter: str = ",", decimal: str = ".") -> str:
    rows = [delimiter.join(f"{v:.3f}".replace(".", decimal) for v in (0.1 * k, k / 3, k / 7)) for k in range(12)]
    return "\n".join(rows) + "\n"


def hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["log/u"], file["Y"], file["Ts"], file["note"] = U, Y, 0.01, "text"
        file["away"] = h5py.ExternalLink("other.h5", "u")


def mat73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        file["Y"] = Y.T
        file["Y"].attrs["MATLAB_class"] = np.bytes_("double")
        file["name"] = np.array([[109], [111]], dtype=np.uint16)
        file["name"].attrs["MATLAB_class"] = np.bytes_("char")


NESTED = {"log": {"u": U, "motor": {"w": 2 * U}}, "Y": Y, "Ts": 0.01, "name": "bench"}
RECORDS = [{"t": 0.1 * k, "motor": {"w": float(k)}, "state": "on"} for k in range(12)]

FILES: dict[str, tuple[Callable[[Path], object], list[str], dict[str, float]]] = {
    "names.csv": (text("t,u,y\n" + numbers()), ["t", "u", "y"], {}),
    "units.csv": (text("t;motor u;y\ns;V;rad/s\n" + numbers(";", ",")), ["t", "motor u", "y"], {}),
    "few units.csv": (text("t;state;y\nms;bool;steps\n" + numbers(";", ",")), ["t", "state", "y"], {}),
    "index.csv": (text(";u;y\ns;V;rad/s\n" + numbers(";", ",")), ["u", "y"], {}),
    "one cell fewer above.csv": (text("Bench 7; operator: K\nt;P;q\n" + numbers(";", ",")), ["t", "P", "q"], {}),
    "as many above.csv": (text("Bench 7; operator: K; 8:00\nt [s];P1;q\n" + numbers(";", ",")), ["t [s]", "P1", "q"], {}),
    "a colon and units.csv": (text("t: time;q: flow;y\ns;V;steps\n" + numbers(";", ",")), ["t: time", "q: flow", "y"], {}),
    "unknown units.csv": (text("Zeit;Weg;Druck\nSek;Meter;Bar\n" + numbers(";", ",")), ["Zeit", "Weg", "Druck"], {}),
    "unknown units and index.csv": (text(";Weg;Druck\nSek;Meter;Bar\n" + numbers(";", ",")), ["Weg", "Druck"], {}),
    "types.csv": (text("time,speed,torque\nfloat,float2,float3\n" + numbers()), ["time", "speed", "torque"], {}),
    "channels.csv": (text("time,n,M\nai0,ai1,ai2\n" + numbers()), ["time", "n", "M"], {}),
    "empty_ends.csv": (text("t;u;y;;\n" + "0,5;0.0;1,5;;\n" * 12), ["t", "u", "y"], {}),
    "preamble.txt": (text("Bench 3\nDate: today\n\nt\tu\ty\n" + numbers("\t")), ["t", "u", "y"], {}),
    "bare.dat": (text(numbers(" ")), ["#1", "#2", "#3"], {}),
    "dates.csv": (text("when,u,y\n" + "".join(f"2024-01-{k + 1:02d},{k},{2 * k}\n" for k in range(12))), ["when", "u", "y"], {}),
    "nested.mat": (lambda p: scipy.io.savemat(p, NESTED), ["log.u", "log.motor.w", "Y[:, 0]", "Y[:, 1]"], {"Ts": 0.01}),
    "old.mat": (lambda p: scipy.io.savemat(p, {"u": U, "Ts": 0.01}, format="4"), ["u"], {"Ts": 0.01}),
    "new.mat": (mat73, ["Y[:, 0]", "Y[:, 1]"], {}),
    "log.h5": (hdf5, ["Y[:, 0]", "Y[:, 1]", "log.u"], {"Ts": 0.01}),
    "log.npz": (lambda p: np.savez(p, u=U, Y=Y, Ts=0.01, name="x"), ["u", "Y[:, 0]", "Y[:, 1]"], {"Ts": 0.01}),
    "fields.npz": (lambda p: np.savez(p, log=np.zeros(12, dtype=[("θ", "f8"), ("u", "f8")])), ["log.θ", "log.u"], {}),
    "log.parquet": (lambda p: pq.write_table(pa.table({"u": U, "name": ["a"] * 12}), p), ["u"], {}),
    "log.json": (
        text(json.dumps({"log": {"u": U.tolist()}, "Ts": 0.01, "runs": [{"w": U.tolist()}]})),
        ["log.u", "runs[0].w"],
        {"Ts": 0.01},
    ),
    "records.json": (text(json.dumps(RECORDS)), ["t", "motor.w"], {}),
    "records.jsonl": (text("\n".join(map(json.dumps, RECORDS))), ["t", "motor.w"], {}),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:Stored array in format 3.0")
@pytest.mark.parametrize("name", FILES)
def test_columns(tmp_path: Path, name: str) -> None:
    write, names, single = FILES[name]
    write(tmp_path / name)
    found = columns_of(tmp_path / name)
    assert sorted(found.names) == sorted(names)
    assert found.numbers == single
    for column in names:
        if column != "when":  # of text, which only reading tells
            assert len(read_table(tmp_path / name, [column]).columns[column]) == 12


def test_every_format_is_listed(tmp_path: Path) -> None:
    for suffix in BUILT_IN:
        file = tmp_path / f"damaged{suffix}"
        file.write_bytes(b"\x00\x01 no recording at all \xff")
        with pytest.raises(UserError, match="damaged"):
            columns_of(file)


def test_a_reader_of_ones_own_cannot_list(tmp_path: Path) -> None:
    register_reader(".own", lambda path, columns: None)  # type: ignore[arg-type, return-value]
    (tmp_path / "a.own").write_text("x")
    try:
        with pytest.raises(UserError, match="cannot list columns"):
            columns_of(tmp_path / "a.own")
    finally:
        unregister_reader(".own")


def test_what_is_said_of_decimals_where_a_line_has_too_few_cells(tmp_path: Path) -> None:
    """That decimals have a point is said where commas separate: only there can a decimal comma be why."""
    (tmp_path / "a.csv").write_text("u;y\n1,5;2,5\n1,5\n")
    (tmp_path / "b.csv").write_text("u,y\n1.5,2.5\n1,5,2,5\n")
    with pytest.raises(UserError, match=r"line 3: found 1 cell.*; semicolons separate cells$"):
        read_table(tmp_path / "a.csv", ("u",))
    with pytest.raises(UserError, match=r"line 3: found 4 cell.*commas separate cells, and decimals have a point$"):
        read_table(tmp_path / "b.csv", ("u",))
