"""A machine over its dates: whether the effect is there, its key parameter, and the other parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from greybox_torch.fleets.charts import Dates, change_sentences, history_chart
from greybox_torch.fleets.history import histories
from greybox_torch.fleets.row import Row

Coulomb = Callable[..., Row]
MONTHS = range(1, 13)
NOISE = [0.01, -0.02, 0.0, 0.02, -0.01, 0.015, -0.015, 0.005, -0.005, 0.01, -0.01, 0.0]


def test_an_effect_that_grows(coulomb: Coulomb) -> None:
    rows = [coulomb("p", (0.3 if m < 8 else 0.5) + NOISE[m - 1], month=m) for m in reversed(MONTHS)]
    (history,) = histories(rows)
    assert history.changed
    assert [row.recorded for row in history.rows][:2] == ["2026-01-01", "2026-02-01"]
    (change,) = history.as_json()
    assert (change["machine"], change["what"]) == ("p", "rotor.coulomb_friction.F_c")
    assert (change["last_before"], change["date"]) == ("2026-07-01", "2026-08-01")
    (sentence,) = change_sentences(history)
    assert sentence.startswith("Coulomb friction at rotor: F_c goes from 0.300 N·m to 0.50")
    assert "between 2026-07-01 and 2026-08-01" in sentence


def test_an_effect_that_appears(coulomb: Coulomb) -> None:
    rows = [coulomb("p", None if m < 7 else 0.3 + NOISE[m - 1], month=m) for m in MONTHS]
    (history,) = histories(rows)
    (change,) = history.as_json()
    assert (change["what"], change["date"]) == ("presence of rotor.coulomb_friction", "2026-07-01")
    assert change_sentences(history)[0].startswith("Coulomb friction at rotor appears between 2026-06-01 and")


def test_a_parameter_of_the_model_that_changes(coulomb: Coulomb) -> None:
    rows = [coulomb("p", None, month=m, J=(0.02 if m < 6 else 0.03) + 0.01 * NOISE[m - 1]) for m in MONTHS]
    (history,) = histories(rows)
    assert [(c["what"], c["date"], c["unit"]) for c in history.as_json()] == [("J", "2026-06-01", "kg m^2")]


def test_nothing_changes(coulomb: Coulomb) -> None:
    (history,) = histories([coulomb("p", 0.3 + NOISE[m - 1], month=m) for m in MONTHS])
    assert not history.changed and history.as_json() == []
    chart = history_chart(history)
    assert "Dashed" not in chart.caption
    (panel,) = (panel for column in chart.columns for panel in column)
    assert panel.title == "Coulomb friction at rotor: F_c"
    dots = next(mark for mark in panel.marks if mark.kind == "dots")
    assert dots.path.count("M") == 12


def test_which_rows_count(coulomb: Coulomb) -> None:
    """Failed and unfinished ones do not, nor machines with one date; those that changed come first."""
    steady = [coulomb("a", 0.3 + NOISE[m - 1], month=m) for m in MONTHS]
    grown = [coulomb("b", (0.3 if m < 8 else 0.5) + NOISE[m - 1], month=m) for m in MONTHS]
    once = [coulomb("c", 0.3, month=1), coulomb("d", 0.3)]
    bad = [replace(coulomb("a", 9.0, month=6), answer=answer) for answer in ("failed", "unfinished")]
    found = histories([*bad, *once, *steady, *grown])
    assert [(history.machine, len(history.rows)) for history in found] == [("b", 12), ("a", 12)]


@pytest.mark.parametrize(
    ("days", "labels"),
    [(365, ["2026-03", "2026-07", "2026-11"]), (40, ["2026-01-11", "2026-01-31"]), (1, ["01-01 06:00", "01-01 18:00"])],
)
def test_dates_on_the_axis(days: int, labels: list[str]) -> None:
    begin = datetime(2026, 1, 1, tzinfo=UTC).timestamp() / 86400.0
    ticks = Dates(begin, begin + days).ticks()
    assert [tick.label for tick in ticks] == labels
    assert all(0.0 < tick.place < 1.0 for tick in ticks)


@pytest.mark.parametrize(
    "times", [("2026-03-01T23:30:00+00:00", "2026-03-02T00:00:00+02:00"), ("2026-03-02", "2026-03-01")]
)
def test_order_of_time(coulomb: Coulomb, times: tuple[str, str]) -> None:
    """The second one is the earlier one."""
    rows = [replace(coulomb("p", 0.3, month=k + 1), recorded=time) for k, time in enumerate(times)]
    (history,) = histories(rows)
    assert [row.recorded for row in history.rows] == [times[1], times[0]]
