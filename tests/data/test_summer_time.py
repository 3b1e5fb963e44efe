"""Local time that leaves an hour out in spring and has one twice in autumn is told as that, gaps of other nights as gaps."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.data.gaps import longest_gap
from greybox_torch.drafting.contradicted_steps import ClosedGap

CARD = """time = "Timestamp"
[channels]
a = { column = "a" }
[[experiment]]
name = "night"
file = "night.csv"
"""


def night(folder: Path, start: str, at: int, hours: int, step: int = 5) -> Path:
    """A file of 60 samples whose clock is set by ``hours`` before sample ``at``, and its card."""
    begin = datetime.fromisoformat(start)
    stamps = [begin + timedelta(minutes=step * k, hours=hours * (k >= at)) for k in range(60)]
    lines = [f"{stamp:%d.%m.%Y %H:%M};{k % 7};{k % 5}" for k, stamp in enumerate(stamps)]
    (folder / "night.csv").write_text("\n".join(["Timestamp;a;b", *lines]) + "\n")
    (folder / "dataset.toml").write_text(CARD)
    return folder / "dataset.toml"


@pytest.mark.parametrize(
    ("step", "start", "last"),
    [
        (5, "2026-03-29 00:00", "2026-03-29 01:55:00"),
        (15, "2026-03-28 20:00", "2026-03-29 01:45:00"),
        (30, "2026-03-28 14:00", "2026-03-29 01:30:00"),
        (60, "2026-03-28 02:00", "2026-03-29 01:00:00"),
    ],
)
def test_an_hour_left_out_in_spring(tmp_path: Path, step: int, start: str, last: str) -> None:
    """Seen: steps of 15 minutes and more made it samples that were lost."""
    path = night(tmp_path, start, 24, 1, step)
    assert not any("missing in" in w.found for w in data_warnings(gt.load_dataset(path), None))
    (told,) = (w for w in data_warnings(gt.load_dataset(path), None) if "gap" in w.found)
    assert f"({last} to 2026-03-29 03:00:00; UTC where" in told.found
    assert "as where local time is set to summer time; then nothing is missing" in told.found
    assert f"sample_time = {60 * step} in the place of time" in told.write
    text = gt.card(tmp_path / "night.csv").text
    assert (
        "set to summer time.\n# Then nothing is missing: give time stamps in UTC" in text
        and "Write two experiments" not in text
    )
    path.write_text(CARD.replace('time = "Timestamp"', f"sample_time = {60.0 * step}"))
    assert not any("gap" in w.found for w in data_warnings(gt.load_dataset(path), None))


def test_an_hour_that_comes_twice_in_autumn(tmp_path: Path) -> None:
    path = night(tmp_path, "2026-10-25 00:00", 36, -1)
    (told,) = gt.card(tmp_path / "night.csv").open
    assert "line 38 is no later than the one before, as where local time is set back from summer time" in told
    with pytest.raises(gt.UserError) as refused:
        gt.load_dataset(path)
    assert "local time is set back from summer time: expected time stamps in UTC" in str(refused.value)


@pytest.mark.parametrize("start", ["2026-03-28 00:00", "2026-06-28 00:00", "2026-03-29 12:00"])
def test_an_hour_that_is_missing_elsewhere_is_a_gap(tmp_path: Path, start: str) -> None:
    """A sample time that closes it is told as well."""
    path = night(tmp_path, start, 24, 1)
    (told,) = (w for w in data_warnings(gt.load_dataset(path), None) if "gap" in w.found)
    assert told.write.startswith("two experiments")
    path.write_text(CARD.replace('time = "Timestamp"', "sample_time = 300.0"))
    (told,) = (w for w in data_warnings(gt.load_dataset(path), None) if isinstance(w, ClosedGap))
    assert 'column "Timestamp" of night.csv has a gap' in told.found and told.write.startswith('time = "Timestamp"')


def test_stamps_without_dates_have_no_summer_time() -> None:
    time = 300.0 * np.arange(60) + 3600.0 * (np.arange(60) > 20)
    gap = longest_gap(time)
    assert gap is not None and not gap.of_summer_time and "UTC" not in str(gap)
