"""Files as instruments and libraries write them: a card is drafted and loaded without a word from the user, and the samples are right."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas
import pytest
import scipy.io

import greybox_torch as gt
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.time_stamps import TimeStamps

N = 40
T = 0.01 * np.arange(N)
U, W = np.round(np.sin(9 * T), 4), np.round(np.cumsum(T), 4)
ROWS = list(zip(T, U, W, strict=True))
TABLE = pandas.DataFrame(
    {"Time": pandas.Timestamp("2026-03-01 23:59:59.8") + pandas.to_timedelta(T, unit="s"), "u": U, "w": W}
)


def lines(head: str, row: str, foot: str = "") -> Callable[[Path], object]:
    """A file of text: what stands above, and a pattern for time, u and w of each sample."""
    return lambda path: path.write_text(head + "".join(row.format(*each) for each in ROWS) + foot, encoding="utf-8")


def times(pattern: str, **options: str) -> Callable[[Path], object]:
    return lambda path: TABLE.assign(Time=TABLE.Time.dt.strftime(pattern)).to_csv(path, index=False, **options)  # type: ignore[call-overload]


LABVIEW = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n***End_of_Header***\t\n\t\nChannels\t2\n"
    "Samples\t40\n***End_of_Header***\nX_Value\tu\tw\tComment\n"
)
SCOPE = (
    "Model,MDO3024\nFirmware Version,1.26\n\nWaveform Type,ANALOG\nSample Interval,0.01\nRecord Length,40\n\nTIME,u,w\n"
)

FILES: dict[str, Callable[[Path], object]] = {
    "labview.lvm": lines(LABVIEW, "{:.6f}\t{:.6f}\t{:.6f}\n"),
    "scope.csv": lines(SCOPE, "{:.6e},{:.6e},{:.6e}\n"),
    "quoted.csv": lines('"t (s)","u","w"\r\n', '"{:.6f}","{:.6f}","{:.6f}"\r\n'),
    "commented.txt": lines("# bench 7\n% t u w\n", "{:.6f} {:.6f} {:.6f}\n"),
    "iso.csv": lambda path: TABLE.to_csv(path, index=False),
    "with index.csv": lambda path: TABLE.to_csv(path),
    "german ä.csv": times("%d.%m.%Y %H:%M:%S.%f", sep=";", decimal=",", encoding="cp1252"),
    "zone.csv": times("%Y-%m-%dT%H:%M:%S.%f+01:00"),
    "savetxt.csv": lambda path: np.savetxt(path, ROWS, header="t,u,w", delimiter=","),
    "savetxt.txt": lambda path: np.savetxt(path, ROWS, header="t u w"),
    "dates.parquet": lambda path: TABLE.to_parquet(path),
    "index.parquet": lambda path: TABLE.set_index("Time").to_parquet(path),
    "dates.npz": lambda path: np.savez(path, Time=TABLE.Time.to_numpy(), u=U, w=W),
    "records.npz": lambda path: np.savez(path, log=np.rec.fromarrays([T, U, W], names="t,u,w")),
    "default.json": lambda path: TABLE.to_json(path, date_format="iso", date_unit="us"),
    "records.json": lambda path: TABLE.to_json(path, orient="records", date_format="iso", date_unit="us"),
    "lines.jsonl": lambda path: TABLE.to_json(path, orient="records", lines=True, date_format="iso", date_unit="us"),
    "simulink.mat": lambda path: scipy.io.savemat(
        path, {"data": {"time": T, "signals": {"values": np.column_stack([U, W]), "label": "u, w"}}}
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_a_card_is_drafted_and_loaded(name: str, tmp_path: Path) -> None:
    FILES[name](tmp_path / name)
    gt.card([tmp_path / name]).save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert sum(len(recording.time) for recording in data.recordings) == N
    first = data.recordings[0]
    assert first.sample_time == pytest.approx(0.01, rel=1e-4)
    assert np.diff(first.time) == pytest.approx(0.01, rel=1e-4)
    u, w = list(first.signals.values())[-2:]
    assert u == pytest.approx(U[: len(u)], abs=1e-5) and w == pytest.approx(W[: len(w)], abs=1e-5)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("1970-01-02T00:00:01", 86401.0),
        ("1970/01/02 00:00:01.25", 86401.25),
        ("02.01.1970 00:00:01,25", 86401.25),
        ("1970-01-01 01:30:00+01:00", 1800.0),
        ("1970-01-01T00:00:00Z", 0.0),
        ("23:59:59.999", 86399.999),
        ("1:00:00 PM", 46800.0),
        ("12:00:00 am", 0.0),
    ],
)
def test_time_stamps(text: str, seconds: float) -> None:
    assert TimeStamps().seconds(text) == pytest.approx(seconds, abs=1e-9)


@pytest.mark.parametrize(
    "text", ["24:00:00", "12:61:00", "2026-02-30 12:00:00", "2026-02-30", "1:5", "12:00", "٣:00:00", "1e3"]
)
def test_what_is_no_time_stamp(text: str) -> None:
    with pytest.raises(ValueError, match=r"time stamp|time of day|no such date"):
        TimeStamps().seconds(text)


def test_a_date_of_two_readings_counts_as_long_as_it_is_one(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("t,u\n" + "".join(f"03/04/2026 12:00:{k:02d},1\n" for k in range(12)))
    assert np.diff(read_table(file, ["t"]).columns["t"]) == pytest.approx(np.ones(11))
    with file.open("a") as more:
        more.write("04/04/2026 12:00:30,1\n")
    with pytest.raises(
        gt.UserError, match=r'line 14, column "t": found "04/04/2026 12:00:30": which number is the day'
    ):
        read_table(file, ["t"])


def test_a_stamp_among_numbers_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("t,u\n0.1,1\n12:00:01,2\n")
    with pytest.raises(gt.UserError, match=r'line 3, column "t": found "12:00:01", expected a number'):
        read_table(file, ["t"])


def test_the_unit_of_the_clock_is_the_files(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t,u\nms,V\n" + "".join(f"{10 * k},{k}\n" for k in range(20)))
    card = tmp_path / "dataset.toml"
    card.write_text(
        'time = "t"\n[channels]\nu = { column = "u", unit = "V" }\n[[experiment]]\nname = "A"\nfile = "a.csv"\n'
    )
    with pytest.raises(
        gt.UserError, match=r'column "t" in "ms", the card says "s"; expected time = { column = "t", unit = "ms" }'
    ):
        gt.load_dataset(card)
    card.write_text(card.read_text().replace('time = "t"', 'time = { column = "t", unit = "ms" }'))
    assert gt.load_dataset(card).recordings[0].sample_time == pytest.approx(0.01)


def test_a_space_separated_comment_is_not_a_column_too_many(tmp_path: Path) -> None:
    """Column "t" of the comment "# t u" is the first one, not the second."""
    np.savetxt(tmp_path / "a.txt", np.column_stack([T, U]), header="t u")
    assert read_table(tmp_path / "a.txt", ["t"]).columns["t"] == pytest.approx(T)


def test_a_field_that_records_lack(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", log=np.rec.fromarrays([T, U], names="t,speed"))
    with pytest.raises(gt.UserError, match=r"no 'sped' in it \(did you mean \"speed\"\?\); found t, speed"):
        read_table(tmp_path / "a.npz", ["log.sped"])


def test_what_stands_below_the_samples_is_told(tmp_path: Path) -> None:
    lines("t,u,w\n", "{:.3f},{:.3f},{:.3f}\n", "\nEnd of recording\n")(tmp_path / "a.csv")
    with pytest.raises(gt.UserError, match=r"a\.csv, line 43: found 1 cell\(s\), expected 3"):
        gt.card([tmp_path / "a.csv"])
