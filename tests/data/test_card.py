"""Every way to get a card wrong is answered in the card's own words."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.data.card import read_card
from greybox_torch.errors import UserError

TOP = 'sample_time = 0.01\nhold = "foh"\n'
CHANNELS = '[channels]\nu = { column = "U", unit = "V" }\n'
EXPERIMENT = '[[experiment]]\nname = "A"\nfile = "a.csv"\n'


def message_of(tmp_path: Path, card: str) -> str:
    path = tmp_path / "dataset.toml"
    path.write_text(card)
    with pytest.raises(UserError) as error:
        read_card(path)
    message = str(error.value)
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


def test_defaults(tmp_path: Path) -> None:
    path = tmp_path / "dataset.toml"
    path.write_text("sample_time = 1\n" + CHANNELS + EXPERIMENT)
    card = read_card(path)
    assert (card.sample_time, card.hold, card.name, card.model.name) == (1.0, "zoh", None, None)
    assert card.channels["u"].scale == 1.0
    assert (card.experiment[0].role, card.experiment[0].rows) == ("estimation", None)


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("a = [\n", "not valid TOML: "),
        ("name = 'x'\nsample_time 3\n", "at line 2"),
        (
            TOP + 'hol = "x"\n' + CHANNELS + EXPERIMENT,
            'unknown key "hol" (did you mean "hold"?); expected name, sample_time',
        ),
        (
            TOP + '[channels]\nu = { colum = "U" }\n' + EXPERIMENT,
            '[channels], u: unknown key "colum" (did you mean "column"?)',
        ),
        (TOP + '[channels]\nu = { unit = "V" }\n' + EXPERIMENT, '[channels], u: "column" is missing'),
        (
            TOP + '[channels]\nu = "U"\n' + EXPERIMENT,
            '[channels], u: found "U", expected a table, like { column = "U", unit = "…" }',
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = 0.012\n",
            "[model.parameters], J: found 0.012, expected a table, like { value = 0.012 }",
        ),
        (
            TOP + CHANNELS + EXPERIMENT + '[model.initial]\nw = "measured"\n',
            '[model.initial], w: found "measured", expected a table, like { value = 0.0 }; to begin as measured, initial="measured"',
        ),
        (TOP + "[channels]\n" + EXPERIMENT, "expected a table [channels] with an entry for every input and output"),
        (TOP + EXPERIMENT, '"channels" is missing; expected a table [channels]'),
        (TOP + CHANNELS, '"experiment" is missing; expected one table [[experiment]]'),
        (TOP + CHANNELS + '[experiment]\nname = "A"\nfile = "a.csv"\n', "expected one table [[experiment]]"),
        (
            TOP + CHANNELS + EXPERIMENT + 'role = "test"\n',
            "[[experiment]] 1 \"A\", role: found \"test\", expected 'estimation' or 'validation'",
        ),
        (TOP + CHANNELS + EXPERIMENT + "rows = [1]\n", "rows: found [1], expected two whole numbers, [start, stop]"),
        (TOP + CHANNELS + EXPERIMENT + "rows = [1.5, 3]\n", "found 1.5, expected a whole number"),
        (TOP + CHANNELS + EXPERIMENT + 'row = "x"\n', '[[experiment]] 1 "A": unknown key "row" (did you mean "rows"?)'),
        (TOP + CHANNELS + '[[experiment]]\nfile = "a.csv"\n', '[[experiment]] 1: "name" is missing'),
        (TOP + CHANNELS + EXPERIMENT + EXPERIMENT, '2 experiments are named "A"; expected different names'),
        (
            TOP + CHANNELS + EXPERIMENT + 'columns = { uu = "x" }\n',
            '[[experiment]] "A", columns: no channel is named "uu" (did you mean "u"?); expected u, time',
        ),
        (TOP + CHANNELS + EXPERIMENT + 'columns = { time = "x" }\n', '"time" needs time = '),
        (
            "sample_time = 0\n" + CHANNELS + EXPERIMENT,
            "sample_time: 0 is not a sample time; expected a number above zero",
        ),
        ("sample_time = -0.1\n" + CHANNELS + EXPERIMENT, "sample_time: -0.1 is not a sample time"),
        ("sample_time = nan\n" + CHANNELS + EXPERIMENT, "sample_time: found NaN, expected a finite number"),
        ("sample_time = '1 ms'\n" + CHANNELS + EXPERIMENT, 'sample_time: found "1 ms", expected a number'),
        ("sample_time = true\n" + CHANNELS + EXPERIMENT, "sample_time: found true, expected a number"),
        (CHANNELS + EXPERIMENT, '"sample_time" is missing'),
        ('time = "t"\n' + TOP + CHANNELS + EXPERIMENT, 'both "sample_time" and "time" are given'),
        (TOP + '[channels]\ntime = { column = "t" }\n' + EXPERIMENT, '"time" cannot name a channel'),
        (TOP + '[channels]\nu = { column = "U", scale = 0 }\n' + EXPERIMENT, "[channels], u, scale: a scale of zero"),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { valu = 1 }\n",
            '[model.parameters], J: unknown key "valu" (did you mean "value"?); expected value, lower, upper, fixed',
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { fixed = 1 }\n",
            "J, fixed: found 1, expected true or false",
        ),
        (TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { lower = nan }\n", "J, lower: nan is not a bound"),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { value = inf }\n",
            "J, value: found Infinity, expected a finite",
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { value = 2, lower = 0, upper = 1 }\n",
            "[model.parameters], J: value = 2 is above upper = 1",
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { value = 500, upper = 100 }\n",
            "[model.parameters], J: value = 500 is above upper = 100",
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { value = -1, lower = 0 }\n",
            "[model.parameters], J: value = -1 is below lower = 0",
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { lower = 1, upper = 1 }\n",
            "[model.parameters], J: lower = 1 is not below upper = 1",
        ),
        (
            TOP + CHANNELS + EXPERIMENT + "[model.initial]\nw = { lower = 1 }\n",
            '[model.initial], w: unknown key "lower"',
        ),
        (TOP + CHANNELS + EXPERIMENT + '[model]\nnam = "x"\n', '[model]: unknown key "nam" (did you mean "name"?)'),
    ],
)
def test_message(tmp_path: Path, card: str, message: str) -> None:
    assert message in message_of(tmp_path, card)


def test_several_problems_are_all_listed(tmp_path: Path) -> None:
    message = message_of(tmp_path, "sample_time = 0\n" + CHANNELS + EXPERIMENT + 'role = "x"\nfoo = 1\n')
    first, *problems = message.splitlines()
    assert first == "3 problems:"
    assert len(problems) == 3


def test_infinite_bounds_are_bounds(tmp_path: Path) -> None:
    path = tmp_path / "dataset.toml"
    path.write_text(TOP + CHANNELS + EXPERIMENT + "[model.parameters]\nJ = { value = 1, lower = -inf, upper = inf }\n")
    assert read_card(path).model.parameters["J"].upper == float("inf")


def test_not_a_card(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"nowhere.toml: no such file; expected a data card"):
        read_card(tmp_path / "nowhere.toml")
    with pytest.raises(UserError, match=r"is a folder without dataset\.toml; expected a data card"):
        read_card(tmp_path)
    (tmp_path / "latin.toml").write_bytes("name = 'Prüfstand'".encode("latin-1"))
    with pytest.raises(UserError, match="not UTF-8 text"):
        read_card(tmp_path / "latin.toml")


@pytest.mark.parametrize("date", ["2026-03-01", "2026-03-01T14:30:00", "2026-03-01T14:30:00Z"])
def test_machine_and_date(tmp_path: Path, date: str) -> None:
    path = tmp_path / "dataset.toml"
    path.write_text(f'machine = "pump 7"\nrecorded = {date}\n' + TOP + CHANNELS + EXPERIMENT)
    card = read_card(path)
    assert card.machine == "pump 7"
    assert card.recorded is not None and card.recorded.isoformat().startswith(date.removesuffix("Z"))


@pytest.mark.parametrize(
    ("date", "found"), [('"2026-03-01"', '"2026-03-01"'), ("20260301", "20260301"), ("14:30:00", '"14:30:00"')]
)
def test_dates_that_are_none(tmp_path: Path, date: str, found: str) -> None:
    message = message_of(tmp_path, f"recorded = {date}\n" + TOP + CHANNELS + EXPERIMENT)
    assert message == f"recorded: found {found}, expected a date without quotes, such as 2026-03-01"


def test_names_of_blanks_and_other_words_for_hold(tmp_path: Path) -> None:
    """Seen: an experiment without a heading or an entry in legends, and "expected 'zoh' or 'foh'" of hold = "linear"."""
    blank = EXPERIMENT.replace(EXPERIMENT.split('name = "')[1].split('"')[0], " ", 1)
    assert "expected a name that can be seen" in message_of(tmp_path, TOP + CHANNELS + blank)
    message = message_of(tmp_path, TOP.replace('"foh"', '"linear"') + CHANNELS + EXPERIMENT)
    assert message.endswith('expected "zoh" (held until the next sample) or "foh" (straight lines between samples)')
