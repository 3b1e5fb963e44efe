"""The page as HTML, and as a browser shows it."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from greybox_torch.api.fleet_result import FleetResult
from greybox_torch.fleets.charts import history_chart
from greybox_torch.fleets.history import histories
from greybox_torch.fleets.in_common import groups
from greybox_torch.fleets.page import counted, render_fleet
from greybox_torch.fleets.row import Row
from tests.browser import BROWSER, needs_browser


@pytest.fixture(scope="module")
def rows(coulomb: Callable[..., Row]) -> list[Row]:
    """Six dated machines of which one changes and one stands out, one with nothing missing, and one that failed."""
    dated = [
        coulomb(f"pump{k}", 0.3 + 0.002 * ((7 * k + 3 * m) % 5) + (0.2 if k == 1 and m > 6 else 0.0), month=m)
        for k in range(6)
        for m in range(1, 13)
    ]
    failed = replace(
        coulomb("<b>bad</b>", None), answer="failed", failure="input", message="dataset.toml: a & b", report=""
    )
    return [*dated, coulomb("a healthy one", None, fit_before=99.123, fit_after=99.123), failed]


@pytest.fixture(scope="module")
def html(rows: list[Row]) -> str:
    return render_fleet(rows, groups(rows), histories(rows), waiting=3)


def text_of(html: str) -> str:
    return " ".join(re.sub(r"<[^>]+>", " ", re.sub(r"<(script|style)>.*?</\1>", "", html, flags=re.DOTALL)).split())


def test_what_is_told(html: str) -> None:
    text = text_of(html)
    assert (
        "7 machines: in 6 something is missing from the model; 1 of 6 recorded over time changed; 1 data set failed."
        in text
    )
    assert "Stopped: 3 data sets not begun or not finished. The same command goes on with them." in text
    assert "an effect with a name 72 nothing missing 1 failed 1" in text
    assert (
        "pump1 : Coulomb friction at rotor: F_c goes from 0.303 N·m to 0.504 N·m between 2026-06-01 and 2026-07-01"
        in text
    )
    assert "F_c = 0.300 ± 0.010 N·m" in text
    assert "80.0 % 98.0 %" in text
    assert "Input at fault more dataset.toml: a &amp; b" in text
    assert "deviation between machines" in text
    assert text.count("No change that is more than chance.") == 5


def test_it_needs_no_network_and_escapes(html: str) -> None:
    assert "<b>bad</b>" not in html and "&lt;b&gt;bad&lt;/b&gt;" in html
    assert not re.search(r'(src|href)="(?!#)(https?:|//)', html)
    assert "<link" not in html and "@import" not in html
    assert '<a href="a%20healthy%20one/report.html">' in html


def test_a_fleet_without_dates_or_verdicts(coulomb: Callable[..., Row]) -> None:
    text = text_of(render_fleet([coulomb("one", 0.3)], (), ()))
    assert "Over time" not in text and "Recorded" not in text and "in common" not in text
    stopped = replace(coulomb("two", None), answer="unfinished")
    assert "something is missing from the model; 1 data set without an answer yet." in text_of(
        render_fleet([coulomb("one", 0.3), stopped], (), ())
    )
    unfinished = Row("three", "c.toml", "unfinished", machine="three", confidence=0.5, seconds=0.00074)
    told = text_of(render_fleet([unfinished], (), ()))
    assert "0.50" not in told and "0.00074" not in told and "under 0.1" in told
    assert "0 machines: in 0 something is missing" in text_of(render_fleet([], (), ()))


def test_a_machine_whose_card_was_read_counts_also_where_it_failed() -> None:
    """Seen: "0 machines" of one whose simulation overflows."""

    def machines(**fields: Any) -> str:
        row = Row("pump", "c.toml", "failed", **{"machine": "pump", **fields})
        return text_of(render_fleet([row], (), ()))

    for fields in ({"failure": "numbers"}, {"failure": "memory"}, {"failure": "killed"}):
        assert "1 machine: in 0 something is missing from the model; 1 data set failed." in machines(**fields)
    for fields in ({"title": "Pump"}, {"machine": "P-7"}, {"fingerprint": "ab"}, {"recorded": "2026-05-01"}):
        assert "1 machine: in 0" in machines(failure="input", **fields)
    assert "0 machines: in 0" in machines(failure="input")


def test_an_unknown_effect_is_not_something_without_a_name(coulomb: Callable[..., Row]) -> None:
    """Seen: "something without a name" of two verdicts with a curve."""
    curve = replace(coulomb("one", None), answer="unknown", effect="an unknown effect at rotor", probability=0.97)
    rows = [curve, replace(coulomb("two", None), answer="unknown")]
    assert counted(rows) == [("unknown", "an unknown effect", 1), ("missing", "something without a name", 1)]
    assert FleetResult(tuple(rows)).sentence == "2 data sets: 1 an unknown effect, 1 something without a name."
    html = render_fleet(rows, (), ())
    assert '<option value="missing">' in html and 'data-answer="missing"' in html and 'data-answer="unknown"' in html


def test_too_few_recordings_are_no_test_of_change(coulomb: Callable[..., Row]) -> None:
    """Seen: "no change that is more than chance" of two verdicts of one date, over an axis of a minute."""
    rows = [replace(coulomb("pump", value, month=1), dataset=f"{value}") for value in (0.3, 0.5)]
    (history,) = histories(rows)
    told = text_of(render_fleet(rows, (), (history,)))
    assert not history.tested and "recorded over time changed" not in told and "more than chance." not in told
    assert "2 dated verdicts are too few to tell a change from chance; 6 are needed." in told
    assert all(re.match(r"\d{4}-", tick.label) for tick in history_chart(history).columns[0][0].x.ticks())


@needs_browser
def test_in_a_browser(html: str, tmp_path: Path) -> None:
    """Searched, filtered and sorted by what stands in the address."""
    page = tmp_path / "fleet.html"
    page.write_text(html, encoding="utf-8")
    address = f"{page.as_uri()}#q=pump1&answer=named&sort=-parameter"
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom"]
    shown = subprocess.run(
        [str(BROWSER), *options, address], capture_output=True, text=True, check=True, timeout=120
    ).stdout
    assert ">12 of 74</output>" in shown
    visible = [
        row
        for row in re.findall(r"<tr (?:class|data)[^>]*>.*?</tr>", shown, re.DOTALL)
        if "hidden" not in row.split(">")[0]
    ]
    levels = [
        float(found) for row in visible for found in re.findall(r'data-label="Key parameter" data-value="([^"]+)"', row)
    ]
    assert len(levels) == 12 and levels == sorted(levels, reverse=True)
    assert 'data-key="parameter" class="number" aria-sort="descending"' in shown
