"""Which column is the clock, and in what unit: dates by their kind, units of time and of pressure as loggers write them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

import greybox_torch as gt
from greybox_torch.api.card import CardResult


def drafted(folder: Path, name: str, stamps: Sequence[str], unit: str = "") -> CardResult:
    units = [f"{unit};;"] if unit else []
    rows = [f"{stamp};{k % 7},5;{k % 5},5" for k, stamp in enumerate(stamps)]
    (folder / "run.csv").write_text("\n".join([f"{name};u;y", *units, *rows]), encoding="utf-8")
    return gt.card(folder / "run.csv")


def dates(*lost: int) -> list[str]:
    return [f"02.03.2026 06:{k // 6:02}:{k % 6}0" for k in range(120) if k not in lost]


@pytest.mark.parametrize("name", ["Zeitstempel", "Datum", "horodatage", "DateTime", "Wann", "A"])
def test_a_column_of_dates_is_the_clock_whatever_is_lost(tmp_path: Path, name: str) -> None:
    """Seen: "no column rises from sample to sample" where rows were lost."""
    card = drafted(tmp_path, name, dates(30, 31, 32, 50))
    assert f'time = "{name}"    # read in s; steps of 10 s' in card.text and not card.open


def test_dates_that_stand_still_are_told_with_the_line(tmp_path: Path) -> None:
    stamps = dates()
    stamps[40] = stamps[39]
    card = drafted(tmp_path, "Wann", stamps)
    (told,) = card.open
    assert (
        'column "Wann" does not rise everywhere: line 42 is no later than the one before; to be mended in run' in told
    )
    assert 'time = "Wann"    # column "Wann" does not rise' in card.text
    seconds = [str(k) for k in range(60)]
    seconds[40] = "39"
    assert "line 42" in drafted(tmp_path, "time", seconds).open[0]
    assert "no column rises" in drafted(tmp_path, "temp", seconds).open[0]


@pytest.mark.parametrize(
    ("said", "unit"), [("msec", "ms"), ("millisec", "ms"), ("sec", "s"), ("seconds", "s"), ("µsec", "us")]
)
def test_units_of_time(tmp_path: Path, said: str, unit: str) -> None:
    """Seen: "steps of 2 s" of a file in msec."""
    card = drafted(tmp_path, "Time", [str(2 * k) for k in range(100)], said)
    assert f"# read in {unit}; steps of 2 {unit}" in card.text
    card.save()
    assert gt.load_dataset(tmp_path / "dataset.toml").channels


def test_units_of_pressure_and_what_is_no_unit(tmp_path: Path) -> None:
    """Seen: "no column fits" alone."""

    class Pipe(gt.GreyBoxModel):
        states = [gt.State("p", "Pa")]
        inputs, outputs = [], [gt.Output("supply_pressure", "Pa")]

    for said, line in (("Bar", 'file_unit = "bar"'), ("bar(g)", 'file_unit = "bar"')):
        rows = [f"{k}\t{k % 7}" for k in range(60)]
        (tmp_path / "p.txt").write_text("\n".join(["t\tP3", f"s\t{said}", *rows]))
        assert line in gt.card(tmp_path / "p.txt", Pipe()).text
    (tmp_path / "p.txt").write_text("\n".join(["t\tDP", "s\tPond", *rows]))
    assert gt.card(tmp_path / "p.txt", Pipe()).open == (
        '[channels] supply_pressure: no column fits; left over: DP (of the unknown unit "Pond")',
    )


def test_the_line_of_an_odd_cell_is_told(tmp_path: Path) -> None:
    """Seen: "without numbers, or of another length"."""

    class Box(gt.GreyBoxModel):
        states = [gt.State("y", "")]
        inputs, outputs = [], [gt.Output("y", "")]

    rows = [f"{k},{k if k != 20 else 'OVER'}" for k in range(60)]
    (tmp_path / "p.csv").write_text("\n".join(["t,y", *rows]))
    card = gt.card(tmp_path / "p.csv", Box())
    taken = '"OVER" in line 22 of p.csv is taken for a missing sample'
    assert f'y = {{ column = "y", unit = "", missing = "OVER" }}    # {taken}' in card.text and not card.open
    card.save()
    assert gt.load_dataset(tmp_path / "dataset.toml").channels
    (tmp_path / "p.csv").write_text("\n".join(["t,y", *rows]).replace("OVER", "2.1.3"))
    assert (
        gt.card(tmp_path / "p.csv", Box())
        .open[0]
        .startswith('[channels] y: column "y" of p.csv, line 22: found "2.1.3"')
    )
    (tmp_path / "p.csv").write_text("\n".join(["t,y", *(f"{k},{'OK' if k % 3 else 1}" for k in range(60))]))
    card = gt.card(tmp_path / "p.csv", Box())
    fault = 'column "y" of p.csv, line 3: found "OK", expected a number'
    assert f"# left out: {fault}" in card.text and card.open[1].startswith(fault)


@pytest.mark.parametrize("odd", ["1.0", "02.03.2026 05:00:00"])
def test_a_column_of_dates_is_kept_where_a_line_is_to_be_mended(tmp_path: Path, odd: str) -> None:
    """Seen: the column was left out, and "no column rises from sample to sample, and no number is called Ts, dt or fs"."""
    stamps = dates()
    stamps[60] = odd
    card = drafted(tmp_path, "Time", stamps)
    (told,) = card.open
    assert told.startswith("time: ") and "line 62" in told and told.endswith("to be mended in run.csv")
    assert card.text.splitlines()[1].startswith('time = "Time"    # column "Time"')


def test_dates_in_a_column_of_their_own(tmp_path: Path) -> None:
    """Seen: "Uhrzeit" does not rise everywhere, and "Datum" left out, of a recording over midnight."""
    at = [f"0{1 + (k >= 5)}.03.2026;{'23:59:' if k < 5 else '00:00:'}{(55 + k) % 60:02},000" for k in range(40)]
    lines = [f"{stamp};{k % 3};{k % 7}" for k, stamp in enumerate(at)]
    (tmp_path / "nacht.csv").write_text("Datum;Uhrzeit;u;y\n" + "\n".join(lines) + "\n")
    card = gt.card(tmp_path / "nacht.csv")
    assert 'time = { column = "Uhrzeit", date = "Datum" }    # read in s; steps of 1 s' in card.text
    assert "Datum = " not in card.text and not card.open
    card.save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert data.recordings[0].seconds == pytest.approx(30.0)


@pytest.mark.parametrize("columns", [("voltage",), ("voltage", "speed")])
@pytest.mark.parametrize("with_model", [True, False])
def test_a_column_of_a_channel_is_no_clock_for_rising_evenly(
    tmp_path: Path, machines: Path, columns: tuple[str, ...], with_model: bool
) -> None:
    """Seen: a file of one column, the ramp of an input, taken for time stamps; "no column fits" that input."""
    rows = [",".join([str(k), "0.5"][: len(columns)]) for k in range(1, 100)]
    (tmp_path / "one.csv").write_text("\n".join([",".join(columns), *rows]))
    (tmp_path / "motor.py").write_text((machines / "motor.py").read_text())
    model = f"{tmp_path / 'motor.py'}:Motor" if with_model else None
    card = gt.card(tmp_path / "one.csv", model)
    taken = len(columns) > 1 and not with_model  # where loggers have the time, of which no name says anything else
    assert ("time = " in card.text.replace("sample_time = ", "")) == taken
    assert ({row["channel"]: row["column"] for row in card.rows}.get("voltage") == "voltage") != taken
