"""Files of several loggers that a card joins to one experiment."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app

N = 100


MODEL = """
import greybox_torch as gt


class Rig(gt.GreyBoxModel):
    states = [gt.State("x", "m")]
    inputs, outputs = [gt.Input("torque", "N m")], [gt.Output("position", "m")]

    def derivative(self, x, u, p, port):
        return {"x": u.torque}

    def output(self, x, u, p):
        return {"position": x.x}
"""


class Rig(gt.GreyBoxModel):
    states = [gt.State("position", "m")]
    inputs, outputs = [gt.Input("valve", "V")], [gt.Output("position", "m"), gt.Output("pressure", "Pa")]


def first(path: Path, start: float = 0.0) -> None:
    rows = [f"{start + 2.0 * k:.1f}\t{np.sin(k):.4f}\t{np.cos(k):.4f}" for k in range(N)]
    path.write_text("\n".join(["Time\tvalve\tposition", "msec\tV\tmm", *rows]))


def second(path: Path, start: float = 0.3) -> None:
    rows = [f"{start + 2.0 * k:.1f}\t{np.sin(k):.4f}" for k in range(N - 2)]
    path.write_text("\n".join(["Time\tpressure", "msec\tbar", *rows]))


def test_two_loggers_of_several_runs_are_joined(tmp_path: Path) -> None:
    """Seen: six experiments, each with half of the channels, and "Next: greybox inspect"."""
    for k in (1, 2, 3):
        first(tmp_path / f"run0{k}_DAQ1.txt")
        second(tmp_path / f"run0{k}_DAQ2.txt")
    card = gt.card(sorted(tmp_path.glob("*.txt"), reverse=True), Rig())
    assert not card.open and len(card.draft.runs) == 3
    assert 'file = ["run02_DAQ1.txt", "run02_DAQ2.txt"]\njoin = "time"' in card.text  # the inputs are not interpolated
    card.save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert [(r.name, r.role) for r in data.recordings] == [
        ("run03", "estimation"), ("run02", "estimation"), ("run01", "validation")
    ]  # fmt: skip
    assert np.nanmax(data.recordings[0].signals["pressure"]) > 9e4
    assert len(card.plot().axes) == 9


def test_one_run_without_a_model(tmp_path: Path) -> None:
    first(tmp_path / "a.txt")
    second(tmp_path / "b.txt")
    gt.card([tmp_path / "a.txt", tmp_path / "b.txt"]).save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert list(data.channels) == ["valve", "position", "pressure"]
    assert [r.rows for r in data.recordings] == [(0, 75), (75, 100)]


@pytest.mark.parametrize("apart", ["time", "names"])
def test_what_may_be_no_run_is_not_joined(tmp_path: Path, apart: str) -> None:
    first(tmp_path / "a.txt")
    second(tmp_path / "b.txt", start=1e5 if apart == "time" else 0.3)
    files = [tmp_path / "a.txt", tmp_path / "b.txt"]
    if apart == "names":  # which belongs to which?
        first(tmp_path / "c.txt")
        second(tmp_path / "d.txt")
        files += [tmp_path / "c.txt", tmp_path / "d.txt"]
    card = gt.card(files, Rig())
    assert 'join = "time"' not in card.text
    assert 'if they are of one run, one experiment with both: file = ["a.txt", "b.txt"], join = "time"' in card.open[-1]


def test_runs_of_one_logger_are_not_joined(tmp_path: Path) -> None:
    """Whatever their columns are called: none of them lacks a channel."""
    for name, columns in (("a.csv", "t,valve,position,pressure"), ("b.csv", "t,valve,pos,press")):
        np.savetxt(tmp_path / name, np.arange(4 * N).reshape(N, 4), "%g", ",", header=columns, comments="")
    assert "join" not in gt.card([tmp_path / "a.csv", tmp_path / "b.csv"], Rig()).text


def test_nothing_is_to_be_inspected_before_the_card_is_filled_in(tmp_path: Path) -> None:
    first(tmp_path / "a.txt")
    (tmp_path / "rig.py").write_text(MODEL)
    done = CliRunner().invoke(app, ["card", str(tmp_path / "a.txt"), "--model", f"{tmp_path / 'rig.py'}:Rig"])
    assert done.exit_code == 0 and "Next:" not in done.stdout
    assert "Fill in what is said above; then greybox inspect" in done.stdout


class Both(Rig):
    inputs, outputs = [gt.Input("valve", "V")], [gt.Output("position", "m"), gt.Output("angle", "rad")]


def third(path: Path, names: str = "valve,position,angle") -> None:
    columns = np.column_stack([0.002 * np.arange(N), *(np.sin(np.arange(N) + k) for k in range(3))])
    np.savetxt(path, columns, "%.6g", ",", header=f"t,{names}", comments="")


def angles(path: Path) -> None:
    path.write_text(
        "\n".join(["Time\tangle", "msec\tmrad", *(f"{0.3 + 2.0 * k:.1f}\t{np.sin(k):.4f}" for k in range(N - 2))])
    )


@pytest.mark.parametrize("names", ["valve,position,angle", "a,b,angle"])
@pytest.mark.parametrize("place", [0, 4])
def test_files_of_another_kind_beside_them_do_not_undo_a_join(tmp_path: Path, names: str, place: int) -> None:
    """Seen: with a complete file of the same machine in the list, each logger's file was an experiment, an encoder alone validation."""
    files = []
    for k in (1, 2):
        first(tmp_path / f"run0{k}_DAQ1.txt")
        angles(tmp_path / f"run0{k}_DAQ2.txt")
        files += [tmp_path / f"run0{k}_DAQ1.txt", tmp_path / f"run0{k}_DAQ2.txt"]
    third(tmp_path / "whole.csv", names)
    files.insert(place, tmp_path / "whole.csv")
    card = gt.card(files, Both())
    joined = [[file.path.name for file in run.files] for run in card.draft.runs if len(run.files) > 1]
    assert joined == [[f"run0{k}_DAQ1.txt", f"run0{k}_DAQ2.txt"] for k in (1, 2)]
    assert not any("if they are of one run" in line for line in card.open)
    if names.startswith("valve"):
        card.save()
        assert len(gt.load_dataset(tmp_path / "dataset.toml").recordings) == 3


def test_a_file_without_its_partner_is_left_alone(tmp_path: Path) -> None:
    for k in (1, 2):
        first(tmp_path / f"run0{k}_DAQ1.txt")
    angles(tmp_path / "run01_DAQ2.txt")
    card = gt.card(sorted(tmp_path.glob("*.txt")), Both())
    assert [(len(run.files)) for run in card.draft.runs] == [2, 1]
    assert card.text.index('role = "validation"') < card.text.index('name = "run02_DAQ1"')  # which lacks the angle


def test_columns_of_channels_that_are_to_be_filled_in_are_a_remark(tmp_path: Path) -> None:
    """Seen: "columns: no channel is named link", a key that the draft itself had written."""
    first(tmp_path / "a.txt")
    third(tmp_path / "b.csv")
    text = gt.card([tmp_path / "a.txt", tmp_path / "b.csv"], Both()).text
    assert '# angle = { column = "…"' in text and '# and, once [channels] has them: angle = "angle"' in text
    (written,) = {line for line in text.splitlines() if line.startswith("columns")}
    assert "angle" not in written


def test_what_parts_lack_is_open_also_behind_a_complete_file(tmp_path: Path) -> None:
    """Seen: nothing open, of two files that could not be simulated and whose times are in columns of two names."""
    third(tmp_path / "whole.csv")
    first(tmp_path / "a.txt")
    third(tmp_path / "n.csv", "angle,current,spare_current")
    card = gt.card([tmp_path / name for name in ("whole.csv", "a.txt", "n.csv")], Both())
    assert any(line.startswith('[[experiment]] "a", angle: no column fits') for line in card.open)
    second(tmp_path / "b.txt")  # of which no column is a channel
    card = gt.card([tmp_path / name for name in ("whole.csv", "a.txt", "b.txt")], Both())
    assert any(line.startswith('[[experiment]] "a", angle: no column fits') for line in card.open)
    assert 'file = ["a.txt", "b.txt"], join = "time"' in card.open[-1]


@pytest.mark.parametrize("order", [1, -1])
def test_the_only_complete_file_is_divided_and_not_proposed_to_be_joined(tmp_path: Path, order: int) -> None:
    """Seen: the one run that a fit can be made from had the role "validation"; with a column too many it was to be joined."""
    first(tmp_path / "a.txt")
    columns = np.column_stack([0.002 * np.arange(N), *(np.sin(np.arange(N) + k) for k in range(4))])
    names = "t,valve,position,angle,temperature"
    np.savetxt(tmp_path / "b.csv", columns, "%.6g", ",", header=names, comments="")
    card = gt.card([tmp_path / "a.txt", tmp_path / "b.csv"][::order], Both())
    assert not any("if they are of one run" in line for line in card.open)
    assert 'name = "b, first part"' in card.text and 'name = "b, last part"' in card.text
