"""A reader from a user's own file: cards name files of its format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError

READER = '''
import numpy as np
import greybox_torch as gt


def read_spaced(path, columns):
    """Columns apart by blanks, their names in the first line."""
    names, *rows = [line.split() for line in path.read_text().splitlines()]
    for column in columns:
        if column not in names:
            raise gt.UserError(f"{path}: no column {column!r}; found {', '.join(names)}")
    values = np.array(rows, dtype=float)
    return gt.Table(path, {c: values[:, names.index(c)] for c in columns}, range(2, len(rows) + 2))


gt.register_reader(".spaced", read_spaced)
'''


def test_a_card_with_files_of_the_format(motor_folder: Callable[..., Path], run_file) -> None:
    folder = motor_folder()
    before = gt.load_dataset(folder / "dataset.toml").recordings[0]
    file = folder / "steps.csv"
    (folder / "steps.spaced").write_text(file.read_text().replace(",", "  "))
    file.unlink()
    card = folder / "dataset.toml"
    card.write_text(card.read_text().replace("steps.csv", "steps.spaced"))
    with pytest.raises(UserError, match=r'no reader for files ending in ".spaced"'):
        gt.load_dataset(card)
    run_file("spaced.py", READER)
    after = gt.load_dataset(card).recordings[0]
    assert set(after.signals) == set(before.signals)
    for channel, values in before.signals.items():
        np.testing.assert_array_equal(after.signals[channel], values)
    card.write_text(card.read_text().replace('"v"', '"volt"'))
    with pytest.raises(UserError, match=r"no column 'volt'; found v, w"):
        gt.load_dataset(card)
    gt.unregister_reader(".spaced")
    with pytest.raises(UserError, match="no reader for files"):
        gt.load_dataset(card)


@pytest.mark.parametrize(
    ("suffix", "reader", "message"),
    [
        ("spaced", print, "suffix is 'spaced'; expected a dot and lower-case letters"),
        (".CSV", print, "suffix is '.CSV'"),
        (".csv", print, 'files ending in ".csv" have a reader already'),
        (".spaced", "read", "reader is 'read'; expected a function"),
    ],
)
def test_what_is_wrong_is_said(suffix: str, reader: object, message: str) -> None:
    with pytest.raises(UserError) as refused:
        gt.register_reader(suffix, reader)  # type: ignore[arg-type]
    assert message in str(refused.value)


def test_only_what_was_registered_is_taken_out() -> None:
    with pytest.raises(UserError, match=r'".csv" was not registered; registered are: none'):
        gt.unregister_reader(".csv")
