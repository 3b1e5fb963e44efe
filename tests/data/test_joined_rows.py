"""Files of equal length whose samples stand side by side: join = "rows"."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from greybox_torch.checking.lone_samples import lone_samples
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.errors import UserError

N = 40
U, Y = np.sin(np.arange(N) / 3), np.cos(np.arange(N) / 3)

Load = Callable[..., DataSet]


@pytest.fixture
def load(tmp_path: Path) -> Load:
    """Writes two files, as columns under a heading (none where that is empty), and a card for both; and loads it."""

    def make(channels: str, *files: tuple[str, np.ndarray], top: str = "sample_time = 0.01", more: str = "") -> DataSet:
        names = [f"{letter}.csv" for letter, _ in zip("abc", files, strict=False)]
        for name, (heading, values) in zip(names, files, strict=True):
            lines = [",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in np.column_stack([values])]
            (tmp_path / name).write_text("\n".join([heading, *lines] if heading else lines))
        listed = ", ".join(f'"{name}"' for name in names)
        card = tmp_path / "dataset.toml"
        card.write_text(
            f'{top}\n[channels]\n{channels}\n[[experiment]]\nname = "A"\nrole = "validation"\nfile = [{listed}]\njoin = "rows"\n{more}\n'
        )
        return load_dataset(card)

    return make


NAMED = 'u = { column = "u", unit = "V" }\ny = { column = "y", unit = "rad/s" }'


def test_columns_by_their_names(load: Load) -> None:
    (a,) = load(NAMED, ("u", U), ("y", Y), more="rows = [5, 35]").recordings
    np.testing.assert_array_equal(a.signals["u"], U[5:35])
    np.testing.assert_array_equal(a.signals["y"], Y[5:35])
    np.testing.assert_allclose(a.time, 0.01 * np.arange(5, 35))


def test_columns_by_positions_counted_over_all_files(load: Load) -> None:
    """Seen: the duty and the speed of a wheel in two files of one column each, without a heading."""
    three = np.column_stack([U, 2 * U])
    channels = "u = { column = 2 }\ny = { column = 3, missing = -999 }"
    y = np.where(np.arange(N) == 7, -999.0, Y)
    data = load(channels, ("", three), ("", y))
    (a,) = data.recordings
    np.testing.assert_array_equal(a.signals["u"], 2 * U)
    np.testing.assert_array_equal(a.signals["y"], np.where(np.arange(N) == 7, np.nan, Y))


def test_a_lone_sample_is_told_with_its_file(load: Load) -> None:
    channels, y = "u = { column = 1 }\ny = { column = 2 }", np.where(np.arange(N) == 20, 500.0, Y)
    (found,) = lone_samples(load(channels, ("", U), ("", y)), {})
    assert "b.csv, line 21, column" in found.found


def test_one_name_in_both_files_is_told_apart_by_position(load: Load) -> None:
    by_position = "u = { column = 1 }\ny = { column = 2 }"
    (a,) = load(by_position, ("value", U), ("value", Y)).recordings
    np.testing.assert_array_equal(a.signals["y"], Y)
    with pytest.raises(UserError, match=r'b.csv: column "value" is in a.csv as well; expected a name .* column = 2'):
        load('u = { column = "value" }', ("value", U), ("value", Y))


def test_time_stamps_may_stand_in_several(load: Load) -> None:
    t = 0.5 * np.arange(N)
    (a,) = load(NAMED, ("t,u", np.column_stack([t, U])), ("t,y", np.column_stack([t, Y])), top='time = "t"').recordings
    np.testing.assert_array_equal(a.time, t)
    np.testing.assert_array_equal(a.signals["y"], Y)


def test_variables_of_matlab_files(tmp_path: Path, load: Load) -> None:
    savemat(tmp_path / "a.mat", {"value": U})
    savemat(tmp_path / "b.mat", {"value": Y})
    card = tmp_path / "dataset.toml"
    card.write_text(
        'sample_time = 0.01\n[channels]\nu = { column = 1 }\ny = { column = 2 }\n[[experiment]]\nname = "A"\nrole = "validation"\n'
        'file = ["a.mat", "b.mat"]\njoin = "rows"\n'
    )
    np.testing.assert_array_equal(load_dataset(card).recordings[0].signals["y"], Y)


def test_files_of_unequal_length(load: Load) -> None:
    with pytest.raises(UserError, match=r'join = "rows" .* found 40 in a.csv, 39 in b.csv; expected as many in each'):
        load(NAMED, ("u", U), ("y", Y[:-1]))


def test_what_is_in_no_file(load: Load) -> None:
    with pytest.raises(UserError, match=r'channel "y": .*no column "y"; it is in none of a.csv, b.csv'):
        load(NAMED, ("u", U), ("z", Y))
    with pytest.raises(UserError, match=r'no column "#3"; found columns: 1 in a.csv, 1 in b.csv'):
        load("u = { column = 1 }\ny = { column = 3 }", ("", U), ("", Y))


def test_a_fault_is_told_with_its_file(load: Load) -> None:
    with pytest.raises(UserError, match=r'b.csv, line 4, column "y", sample 2 .*: found inf'):
        load(NAMED, ("u", U), ("y", np.where(np.arange(N) == 2, np.inf, Y)))


def test_a_join_in_time_without_time_stamps_names_it(load: Load) -> None:
    with pytest.raises(UserError, match=r'join = "time" needs time stamps; .* join = "rows"'):
        load(NAMED, ("u", U), ("y", Y), more='[[experiment]]\nname = "B"\nfile = ["a.csv", "b.csv"]\njoin = "time"')
