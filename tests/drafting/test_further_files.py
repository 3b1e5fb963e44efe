"""Cards for files that name their columns differently, have a matrix with its time in the first column, or belong together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.io

import greybox_torch as gt
from greybox_torch.drafting.likened import likened, of_the_same_last_name

N = 100
T = 0.02 * np.arange(N)
V, Q = np.sin(T), np.cos(3 * T)


class Arm(gt.GreyBoxModel):
    """An arm with its angle measured."""

    states = (gt.State("angle", "rad"), gt.State("speed", "rad/s"))
    inputs = (gt.Input("voltage", "V"),)
    outputs = (gt.Output("angle", "rad"),)
    parameters = (gt.Parameter("k", 1.0),)

    def derivative(self, x, u, p, port):
        return {"angle": x.speed, "speed": p.k * u.voltage}

    def output(self, x, u, p):
        return {"angle": x.angle}


def test_an_angle_with_its_unit_goes_before_counts_and_the_second_file_has_the_same_names_with_an_ending(
    tmp_path: Path,
) -> None:
    """Seen: y, which are counts, taken for an angle in rad, though yrad was beside it; and uval, yradval of the second file not at all."""
    counts = (1000 * Q).astype(np.uint16)
    scipy.io.savemat(tmp_path / "a.mat", {"i": V, "u": V, "y": counts, "yrad": Q, "yradde": Q})
    scipy.io.savemat(
        tmp_path / "b.mat", {"ival": V, "uval": V, "uvalde": V, "yradval": Q, "yradvalde": Q, "yval": counts}
    )
    drafted = gt.card([tmp_path / "a.mat", tmp_path / "b.mat"], Arm(), sample_time=0.02)
    assert {row["channel"]: row["column"] for row in drafted.rows} == {"voltage": "u", "angle": "yrad"}
    assert 'columns = { voltage = "uval", angle = "yradval" }' in drafted.text
    drafted.save()
    loaded = gt.load_dataset(drafted.path)
    np.testing.assert_allclose(loaded.recordings[1].signals["angle"], Q)


def test_a_unit_that_follows_the_letter_of_an_output_is_converted(tmp_path: Path) -> None:
    scipy.io.savemat(tmp_path / "a.mat", {"u": V, "ydeg": Q})
    drafted = gt.card(tmp_path / "a.mat", Arm(), sample_time=0.02)
    assert 'column = "ydeg", unit = "rad", file_unit = "deg"' in drafted.text


@pytest.mark.parametrize(
    ("columns", "found"),
    [
        (["uval", "uvalde", "yval"], {"v": "uval", "w": "yval"}),
        (["val_u", "val_y", "t"], {"v": "val_u", "w": "val_y"}),
        (["u", "yval"], {}),
        (["uval", "y2"], {}),
        ([], {}),
    ],
)
def test_columns_with_one_ending_or_beginning(columns: list[str], found: dict[str, str]) -> None:
    assert likened({"v": "u", "w": "y"}, columns) == found


def test_one_column_is_not_taken_for_two_channels() -> None:
    assert of_the_same_last_name({"a": "x.v", "b": "y.v", "c": "x.w"}, {}, ["z.v", "z.w"]) == {"c": "z.w"}


def test_the_first_column_of_a_matrix_may_be_the_time(tmp_path: Path) -> None:
    """Seen: "no column rises from sample to sample", of a matrix whose first column was 0, 0.001, 0.002 …"""
    scipy.io.savemat(tmp_path / "a.mat", {"Iz": Q, "data": np.column_stack([T, V, Q])})
    drafted = gt.card(tmp_path / "a.mat")
    assert drafted.draft.clock.column == "data[:, 0]" and not drafted.open


def test_input_and_output_in_files_of_their_own_are_told(tmp_path: Path) -> None:
    """Seen: two files of one column each drafted as two experiments of one channel, without a word."""
    for name, values in (("in", V), ("out", Q)):
        (tmp_path / f"{name}.csv").write_text("\n".join(f"{v:.9g}" for v in values))
    files = [tmp_path / "in.csv", tmp_path / "out.csv"]
    for drafted in (gt.card(files), gt.card(files, Arm())):
        (told,) = (line for line in drafted.open if "one run" in line)
        assert (
            'file = ["in.csv", "out.csv"], join = "rows", and their columns by position: column = 1 to column = 2'
            in told
        )
    (tmp_path / "out.csv").write_text("\n".join(f"{v:.9g}" for v in Q[:-1]))
    assert not any("one run" in line for line in gt.card(files).open)


def test_what_further_files_lack_and_do_not_say_is_told(tmp_path: Path) -> None:
    """Seen: three files, the second without an output, the third without the input and in milliseconds, and only the first was told of."""
    (tmp_path / "a.csv").write_text(
        "t [s],voltage,angle [deg]\n" + "".join(f"{t},{v},{q}\n" for t, v, q in zip(T, V, Q, strict=True))
    )
    scipy.io.savemat(tmp_path / "b.mat", {"t": T, "voltage": V, "angle_slow": Q[::5]})
    scipy.io.savemat(tmp_path / "c.mat", {"t_ms": 1000 * T, "torque": V, "angle_c": Q})
    told = gt.card([tmp_path / f"{name}" for name in ("a.csv", "b.mat", "c.mat")], Arm()).open
    assert (
        told[0]
        == '[[experiment]] "b", angle: no column fits; of another length: angle_slow; else leave the experiment out'
    )
    assert told[1] == '[[experiment]] "c", voltage: no column fits; left over: torque; else leave the experiment out'
    assert told[2] == (
        '[[experiment]] "c", angle: no unit is said: deg by its size beside that of "angle [deg]" of a.csv; please check'
    )
    assert len(told) == 3


def test_units_of_further_files_that_are_not_those_of_the_first(tmp_path: Path) -> None:
    """Seen: an angle in rad "converted from deg" as the first file's is, and three of four files sent to a card of their own, as one logger
    counted in ms.
    """
    rows = zip(T, V, np.degrees(Q), strict=True)
    (tmp_path / "a.csv").write_text("t_ms,voltage,angle [deg]\n" + "".join(f"{1000 * t},{v},{q}\n" for t, v, q in rows))
    scipy.io.savemat(tmp_path / "b.mat", {"log": {"t": T, "voltage": 1000 * V, "angle": Q}})
    rows = zip(T, 1000 * V, Q, strict=True)
    (tmp_path / "c.csv").write_text(
        "t,voltage [mV],angle [rad]\n" + "".join(f"{1000 * t},{v},{q}\n" for t, v, q in rows)
    )
    drafted = gt.card([tmp_path / name for name in ("a.csv", "b.mat", "c.csv")], Arm())
    assert drafted.open == (
        '[[experiment]] "b", angle: no unit is said: rad by its size beside that of "angle [deg]" of a.csv; please check',
    )
    assert "# angle: no unit is said: rad by its size" in drafted.text
    assert (
        'angle = { column = "log.angle", file_unit = "rad" }, time = { column = "log.t", unit = "s" }' in drafted.text
    )
    assert 'voltage = { column = "voltage [mV]", file_unit = "mV" }' in drafted.text and 'time = "t" }' in drafted.text
    told = drafted.content(tmp_path)["runs"]
    assert [run["name"] for run in told] == ["a", "b", "c"] and told[0]["columns"] == {}
    assert told[1]["columns"]["angle"] == {"column": "log.angle", "file_unit": "rad"}
    assert told[2]["columns"]["time"] == {"column": "t"}
    drafted.save()
    first, *others = gt.load_dataset(drafted.path).recordings
    for other in others:
        np.testing.assert_allclose(other.signals["angle"], first.signals["angle"], atol=1e-12)
        np.testing.assert_allclose(other.time, first.time, atol=1e-12)
    np.testing.assert_allclose(others[1].signals["voltage"], first.signals["voltage"], atol=1e-12)


class Room(Arm):
    """A temperature in the place of the angle."""

    outputs = (gt.Output("angle", "degC"),)


@pytest.mark.parametrize(("added", "unit"), [(0.0, "degC"), (273.15, "K")])
def test_a_unit_with_another_zero_is_told_by_its_size(tmp_path: Path, added: float, unit: str) -> None:
    temperature = 15.0 + Q
    for name, column, values in (("a", "angle [K]", temperature + 273.15), ("b", "angle", temperature + added)):
        rows = zip(T, V, values, strict=True)
        (tmp_path / f"{name}.csv").write_text(f"t,voltage,{column}\n" + "".join(f"{t},{v},{q}\n" for t, v, q in rows))
    drafted = gt.card([tmp_path / "a.csv", tmp_path / "b.csv"], Room())
    assert any(f"no unit is said: {unit} by its size" in line for line in drafted.open)
    drafted.save()
    first, second = gt.load_dataset(drafted.path).recordings
    np.testing.assert_allclose(second.signals["angle"], first.signals["angle"], atol=1e-9)


def test_a_column_of_the_same_name_inside_of_a_structure(tmp_path: Path) -> None:
    """Seen: "no column fits; left over: log.az, log.vbat" of the file behind one whose az was taken."""
    rows = zip(T, V, Q, strict=True)
    (tmp_path / "a.csv").write_text("t,voltage,enc [rad]\n" + "".join(f"{t},{v},{q}\n" for t, v, q in rows))
    scipy.io.savemat(tmp_path / "b.mat", {"log": {"t": T, "voltage": V, "enc": Q, "other": V}})
    drafted = gt.card([tmp_path / "a.csv", tmp_path / "b.mat"], Arm())
    assert 'angle = "log.enc"' in drafted.text and not drafted.open


def test_a_column_inside_a_structure_is_told_with_those_beside_it(tmp_path: Path) -> None:
    """Seen: 'no column "Vitesse bande"; found log', and not a word of log.slow.v_belt."""
    scipy.io.savemat(tmp_path / "a.mat", {"log": {"t": T, "u": V, "slow": {"y": Q[::5]}}})
    card = tmp_path / "dataset.toml"
    card.write_text(
        'time = "log.t"\n[channels]\nvoltage = { column = "log.u" }\nangle = { column = "angle" }\n'
        '[[experiment]]\nname = "a"\nfile = "a.mat"\n'
    )
    with pytest.raises(gt.UserError, match=r'no column "angle".*; found log\.t, log\.u, log\.slow\.y'):
        gt.load_dataset(card)


def test_decimal_commas_between_commas_are_told(tmp_path: Path) -> None:
    """Seen: "no column #1; found 3 columns of numbers, the first of which is #1"."""
    rows = "".join(f"03.11.2025,07:15:0{k},000,0,00,-1,32,0,060,40,0\n" for k in range(9))
    (tmp_path / "a.csv").write_text(f"Belt 3, drive A, Mueller\n\nDatum,Uhrzeit,M [Nm],n [1/min],v [m/min],T\n{rows}")
    with pytest.raises(gt.UserError, match=r"has a number in #1 and nothing but.* decimal commas, semicolons or tabs"):
        gt.card(tmp_path / "a.csv", Arm())
