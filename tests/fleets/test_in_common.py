"""What machines with one effect have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from greybox_torch.fleets.in_common import groups, latest
from greybox_torch.fleets.row import Row

LEVELS = [0.30, 0.31, 0.29, 0.32, 0.28, 0.30, 0.31, 0.60]


def test_an_outlier(coulomb: Callable[..., Row]) -> None:
    rows = [coulomb(f"p{k}", level) for k, level in enumerate(LEVELS)]
    (group,) = groups([*rows, coulomb("healthy", None)])
    assert (group.name, group.unit, len(group.rows), group.of) == ("Coulomb friction at rotor: F_c", "N m", 8, 9)
    told = group.as_json()
    assert [entry["machine"] for entry in told["outliers"]] == ["p7"]
    assert set(told["shrunken"]) == {row.machine for row in rows}
    assert told["mean"] == pytest.approx(sum(LEVELS) / 8, rel=0.05)


def test_the_latest_recording_of_each_machine_counts(coulomb: Callable[..., Row]) -> None:
    rows = [coulomb(f"p{k}", 0.3 + 0.01 * month, month=month) for k in range(5) for month in (3, 1, 2)]
    (group,) = groups(rows)
    assert [row.value for row in group.rows] == [pytest.approx(0.33)] * 5


def test_the_latest_is_told_by_the_moment_and_not_by_how_it_is_written(coulomb: Callable[..., Row]) -> None:
    """Seen: 23:00 in a zone one hour ahead taken as later than 22:30 UTC, half an hour after it."""
    earlier, later = coulomb("p", 0.3, month=3), coulomb("p", 0.4, month=3)
    rows = [
        replace(later, recorded="2026-03-01T22:30:00+00:00"),
        replace(earlier, recorded="2026-03-01T23:00:00+01:00"),
    ]
    assert [row.value for row in latest(rows)] == [later.value]
    assert latest([rows[1], replace(later, recorded=None)]) == [rows[1]]


def test_too_few_or_without_a_deviation(coulomb: Callable[..., Row]) -> None:
    rows = [coulomb(f"p{k}", 0.3) for k in range(5)]
    assert groups(rows[:4]) == ()
    assert groups([*rows[:4], replace(rows[4], std=None)]) == ()
    assert groups([*rows[:4], replace(rows[4], answer="failed")]) == ()
