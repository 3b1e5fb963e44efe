from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greybox_torch.data import Channel, load_dataset
from greybox_torch.errors import UserError

Edit = Callable[[Path, str, str], None]
ROBOT_ARM = Path(__file__).parents[3] / "shared" / "recordings" / "robot_arm" / "dataset.toml"


def test_reads_what_the_card_says(bench: Path) -> None:
    data = load_dataset(bench / "dataset.toml")
    assert (data.name, data.hold, data.model, data.held_out_by_default) == ("Bench motor", "zoh", None, False)
    assert data.channels == {"voltage": Channel("voltage", "V"), "speed": Channel("speed", "rad/s")}
    (steps,), (sweep,) = data.estimation(), data.validation()
    assert (steps.name, len(steps), steps.rows, steps.source) == ("Steps", 40, (0, 40), bench / "steps.csv")
    assert (sweep.name, len(sweep), sweep.sample_time) == ("Sweep", 20, 0.01)
    np.testing.assert_allclose(steps.time, 0.01 * np.arange(40), atol=1e-15)
    assert steps.signals["speed"][8] == 2.0 * 8 / 4
    assert np.isnan(steps.signals["speed"][7])
    np.testing.assert_array_equal(sweep.signals["voltage"], np.arange(20.0))
    assert data.parameters["J"].value == 0.5
    assert data.parameters["J"].fixed is None


def test_accepts_a_path_as_text(bench: Path) -> None:
    assert load_dataset(str(bench / "dataset.toml")).path == bench / "dataset.toml"


def test_name_defaults_to_the_folder(bench: Path, edit: Edit) -> None:
    edit(bench / "dataset.toml", 'name = "Bench motor"\n', "")
    assert load_dataset(bench / "dataset.toml").name == "bench"


@given(start=st.integers(0, 30), length=st.integers(10, 40))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_rows_are_a_slice_of_the_whole(bench: Path, start: int, length: int) -> None:
    stop = min(start + length, 40)
    card = (bench / "dataset.toml").read_text()
    (bench / "sliced.toml").write_text(card.replace('role = "estimation"', f"rows = [{start}, {stop}]"))
    whole = load_dataset(bench / "dataset.toml").recordings[0]
    sliced = load_dataset(bench / "sliced.toml").recordings[0]
    assert sliced.rows == (start, stop)
    np.testing.assert_array_equal(sliced.time, whole.time[start:stop])
    for channel, values in whole.signals.items():
        np.testing.assert_array_equal(sliced.signals[channel], values[start:stop])


@pytest.mark.parametrize("rows", ["[0, 41]", "[-1, 20]", "[20, 20]", "[30, 10]"])
def test_rows_out_of_range(bench: Path, edit: Edit, rows: str) -> None:
    edit(bench / "dataset.toml", 'role = "estimation"', f"rows = {rows}")
    with pytest.raises(UserError) as error:
        load_dataset(bench / "dataset.toml")
    assert f'[[experiment]] "Steps", rows: found {rows}, expected 0 <= start < stop <= 40' in str(error.value)


def test_rows_of_a_file_without_samples(bench: Path, edit: Edit) -> None:
    """Seen: "rows: found [0, 20], expected 0 <= start < stop <= 0"."""
    edit(bench / "dataset.toml", 'role = "estimation"', "rows = [0, 20]")
    (bench / "steps.csv").write_text("t,u,y\n")
    with pytest.raises(UserError, match=r'steps.csv: has no samples; expected .* \[\[experiment\]\] "Steps"\)$'):
        load_dataset(bench / "dataset.toml")


def test_ten_samples_are_enough_and_nine_are_not(bench: Path, edit: Edit) -> None:
    edit(bench / "dataset.toml", 'role = "estimation"', "rows = [0, 10]")
    assert len(load_dataset(bench / "dataset.toml").recordings[0]) == 10
    edit(bench / "dataset.toml", "rows = [0, 10]", "rows = [0, 9]")
    with pytest.raises(UserError, match=r'"Steps": has 9 samples; expected at least 10'):
        load_dataset(bench / "dataset.toml")


def with_time_stamps(bench: Path, edit: Edit) -> Path:
    edit(bench / "dataset.toml", "sample_time = 0.01", 'time = "t"')
    return bench / "dataset.toml"


def test_time_stamps(bench: Path, edit: Edit) -> None:
    steps, sweep = load_dataset(with_time_stamps(bench, edit)).recordings
    assert steps.sample_time == pytest.approx(0.01)
    assert sweep.sample_time == pytest.approx(0.02)
    assert sweep.time[-1] == 19 * 0.02
    assert list(steps.signals) == ["voltage", "speed"]


def test_time_column_of_one_file(bench: Path, edit: Edit) -> None:
    card = with_time_stamps(bench, edit)
    edit(card, '{ voltage = "u_val" }', '{ voltage = "u_val", time = "seconds" }')
    np.savez(bench / "sweep.npz", u_val=np.arange(20.0), y=np.arange(20.0), seconds=np.arange(20) + 5.0)
    assert load_dataset(card).recordings[1].time[0] == 5.0


@pytest.mark.parametrize(
    ("stamp", "message"),
    [
        ("0.18", 'line 21, column "t", sample 19 (the first is 0): found 0.18 s after 0.18 s'),
        ("0.17", "found 0.17 s after 0.18 s; expected time stamps that increase"),
        ("", 'line 21, column "t", sample 19 (the first is 0): the time stamp is missing'),
        ("inf", 'line 21, column "t", sample 19 (the first is 0): found inf, expected a finite number'),
    ],
)
def test_faulty_time_stamp(bench: Path, edit: Edit, stamp: str, message: str) -> None:
    card = with_time_stamps(bench, edit)
    edit(bench / "steps.csv", "\n0.19,", f"\n{stamp},")
    edit(card, 'role = "estimation"', "rows = [5, 40]")
    with pytest.raises(UserError) as error:
        load_dataset(card)
    assert message in str(error.value)


@pytest.mark.parametrize("before", [1, 10])
def test_a_time_of_day_that_passes_midnight(bench: Path, before: int) -> None:
    clock = [f"23:59:{60 - before + k}" if k < before else f"00:00:{k - before:02}" for k in range(40)]
    (bench / "steps.csv").write_text("t,u,y\n" + "".join(f"{at},{k},{k}\n" for k, at in enumerate(clock)))
    (bench / "dataset.toml").write_text(
        'time = "t"\n[channels]\nvoltage = { column = "u" }\n[[experiment]]\nname = "Steps"\nfile = "steps.csv"\n'
    )
    with pytest.raises(UserError) as error:
        load_dataset(bench / "dataset.toml")
    assert '[[experiment]] "Steps": ' in str(error.value) and f"line {2 + before}" in str(error.value)
    said = str(error.value)
    assert 'passes midnight here: give stamps with the date (of a column beside it: time = { column = "…", date' in said
    assert "or sample_time = 1 in the place of time" in said


def test_infinite_value(bench: Path, edit: Edit) -> None:
    edit(bench / "steps.csv", "\n0.19,4,4.75", "\n0.19,4,-inf")
    with pytest.raises(
        UserError, match=r'steps.csv, line 21, column "y", sample 19 .*found -inf, expected a finite number'
    ):
        load_dataset(bench / "dataset.toml")


def test_all_missing_channel(bench: Path) -> None:
    np.savez(bench / "sweep.npz", u_val=np.arange(20.0), y=np.full(20, np.nan))
    with pytest.raises(
        UserError, match=r'"Sweep", channel "speed": all 20 samples are missing \(NaN\), rows \[0, 20\] of .*sweep.npz'
    ):
        load_dataset(bench / "dataset.toml")


def test_columns_of_different_length(bench: Path) -> None:
    np.savez(bench / "sweep.npz", u_val=np.arange(20.0), y=np.arange(19.0))
    with pytest.raises(
        UserError, match=r'sweep.npz: columns differ in length: "u_val" has 20, "y" has 19; .* join = "time" joins'
    ):
        load_dataset(bench / "dataset.toml")


def test_last_quarter_is_held_out_without_a_validation_role(bench: Path, edit: Edit) -> None:
    edit(bench / "dataset.toml", 'role = "validation"', 'role = "estimation"')
    data = load_dataset(bench / "dataset.toml")
    assert data.held_out_by_default
    assert [(r.name, r.role, r.rows) for r in data.recordings] == [
        ("Steps", "estimation", (0, 30)),
        ("Steps (held out)", "validation", (30, 40)),
        ("Sweep", "estimation", (0, 15)),
        ("Sweep (held out)", "validation", (15, 20)),
    ]
    assert data.recordings[1].time[0] == pytest.approx(0.30)


def test_channel_that_is_missing_throughout_the_held_out_quarter(bench: Path, edit: Edit) -> None:
    edit(bench / "dataset.toml", 'role = "validation"', 'role = "estimation"')
    y = np.arange(20.0)
    y[15:] = np.nan
    np.savez(bench / "sweep.npz", u_val=np.arange(20.0), y=y)
    with pytest.raises(UserError, match=r'"Sweep \(held out\)", channel "speed": all 5 samples are missing'):
        load_dataset(bench / "dataset.toml")


def test_model_file_is_relative_to_the_card(bench: Path, edit: Edit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(bench.parent)
    card = bench / "dataset.toml"
    edit(card, "[model.parameters]", '[model]\nname = "my_motor.py:Motor"\n[model.parameters]')
    assert load_dataset("bench/dataset.toml").model == f"{bench.resolve()}/my_motor.py:Motor"
    edit(card, '"my_motor.py:Motor"', '"robot_arm"')
    assert load_dataset("bench/dataset.toml").model == "robot_arm"


def test_hash_is_of_the_samples_alone(bench: Path, edit: Edit) -> None:
    before = load_dataset(bench / "dataset.toml").sha256
    edit(bench / "dataset.toml", 'name = "Steps"', 'name = "Stairs"')
    assert load_dataset(bench / "dataset.toml").sha256 == before
    edit(bench / "steps.csv", "\n0.19,4,4.75", "\n0.19,4,4.7500000000000009")
    assert load_dataset(bench / "dataset.toml").sha256 != before


def test_part(bench: Path) -> None:
    steps = load_dataset(bench / "dataset.toml").recordings[0].part(4, 34)
    part = steps.part(2, 10, name="first", role="validation")
    assert (part.name, part.role, part.rows, len(part), part.sample_time) == ("first", "validation", (6, 14), 8, 0.01)
    assert part.time[0] == steps.time[2]
    for start, stop in [(-1, 3), (3, 3), (0, 31)]:
        with pytest.raises(UserError, match=r"recording 'Steps': part\("):
            steps.part(start, stop)


def test_data_set_is_frozen(bench: Path) -> None:
    data = load_dataset(bench / "dataset.toml")
    with pytest.raises(dataclasses.FrozenInstanceError):
        data.name = "other"  # type: ignore[misc]


@pytest.mark.skipif(not ROBOT_ARM.exists(), reason="the real recordings, ../shared/recordings, are not here")
def test_real_robot_arm() -> None:
    data = load_dataset(ROBOT_ARM)
    assert [(r.name, r.role, len(r)) for r in data.recordings] == [
        ("Estimation", "estimation", 19838),
        ("Validation 1", "validation", 19838),
    ]
    assert data.model == "robot_arm"
    assert data.parameters["k_g3"].value == 0.0
    assert data.initial["gear_twist"].fixed is True
    assert all(np.isfinite(v).all() for r in data.recordings for v in r.signals.values())
    assert data.recordings[0].signals["motor_speed"].std() > 10.0
