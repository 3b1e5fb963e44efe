"""Samples that are both estimated from and judged on are told, with the experiments, the file and the rows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.checking.shared_rows import shared_rows
from greybox_torch.cli import app
from greybox_torch.data import load_dataset

COLUMNS = "u,y,u2,y2"
CARD = """
sample_time = 0.01
[channels]
u = { column = "u" }
y = { column = "y" }
"""


def told(folder: Path, *experiments: str) -> list[str]:
    for k, file in enumerate(("a.csv", "b.csv", "copy.csv")):
        (folder / file).write_text("\n".join([COLUMNS, *(f"{k % 2},0,1,1" for _ in range(100))]))
    entries = (f'[[experiment]]\nname = "{k}"\n{entry}\n' for k, entry in enumerate(experiments))
    (folder / "dataset.toml").write_text(CARD + "".join(entries))
    return [str(one) for one in shared_rows(load_dataset(folder / "dataset.toml"))]


A, B, JUDGED = 'file = "a.csv"\n', 'file = "b.csv"\n', 'role = "validation"\n'
COPY = 'file = "copy.csv"\n'
BOTH = 'file = ["b.csv", "a.csv"]\njoin = "concatenate"\n'


@pytest.mark.parametrize(
    ("experiments", "shared"),
    [
        ((A, A + JUDGED), "all of a.csv"),
        ((A, 'file = "./a.csv"\nrows = [20, 90]\n' + JUDGED), "rows [20, 90] of a.csv"),
        ((A + "rows = [20, 90]\n" + JUDGED, A + "rows = [0, 30]\n"), "rows [20, 30] of a.csv"),
        ((BOTH, A + "rows = [20, 90]\n" + JUDGED), "rows [20, 90] of a.csv"),
        ((A, COPY + JUDGED), "all of a.csv, of which copy.csv is a copy"),
        (
            (A + "rows = [0, 50]\n", COPY + "rows = [30, 90]\n" + JUDGED),
            "rows [30, 50] of a.csv, of which copy.csv is a copy",
        ),
        ((BOTH + "rows = [0, 50]\n", BOTH + "rows = [30, 150]\n" + JUDGED), "rows [30, 50] of b.csv"),
    ],
)
def test_told(tmp_path: Path, experiments: tuple[str, str], shared: str) -> None:
    estimated, judged = (0, 1) if JUDGED in experiments[1] else (1, 0)
    (one,) = told(tmp_path, *experiments)
    assert one.startswith(f'[[experiment]] "{estimated}" (estimation) and "{judged}" (validation) both have {shared}: ')


def test_the_quarter_that_is_held_out_of_one_is_estimated_from_in_another(tmp_path: Path) -> None:
    (one,) = told(tmp_path, A + "rows = [0, 60]", A + "rows = [40, 100]")
    assert '"0" and "1" both have rows [40, 60] of a.csv, and the last quarter of each is held out' in one


@pytest.mark.parametrize(
    "experiments",
    [
        (A, B + JUDGED),
        (A + "rows = [0, 50]\n", COPY + "rows = [50, 100]\n" + JUDGED),
        (A + "rows = [0, 50]\n", A + "rows = [50, 100]\n" + JUDGED),
        (A, A, B + JUDGED),  # the same role twice harms nobody
        (A, A + JUDGED + 'columns = { u = "u2", y = "y2" }'),  # two runs side by side
        (A, A),  # the same quarter of both is held out
    ],
)
def test_not_told(tmp_path: Path, experiments: tuple[str, ...]) -> None:
    assert told(tmp_path, *experiments) == []


@pytest.mark.parametrize("own", ['{ column = "u", scale = 1.0 }', '{ column = "u" }', '{ expr = "u" }'])
def test_the_same_column_of_another_scale_is_no_other_run(tmp_path: Path, own: str) -> None:
    (one,) = told(tmp_path, A, A + JUDGED + f"columns = {{ u = {own} }}")
    assert "both have all of a.csv" in one


@pytest.mark.parametrize("command", ["check", "inspect", "simulate"])
def test_commands_warn(motor_folder: Callable[..., Path], tmp_path: Path, command: str) -> None:
    path = motor_folder() / "dataset.toml"
    path.write_text(path.read_text().replace('file = "sweep.csv"', 'file = "steps.csv"\nrows = [100, 600]'))
    out = [] if command == "check" else ["--out", str(tmp_path / "out")]
    done = CliRunner().invoke(app, [command, str(path), *out])
    assert done.exit_code == 0, done.output
    assert '"Steps" (estimation) and "Sweep" (validation) both have rows [100, 600] of steps.csv' in done.output
