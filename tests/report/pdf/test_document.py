"""The report for print: it holds what the page says, on sheets that nothing runs off."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.about import About
from greybox_torch.report.pdf import sheets as paper
from greybox_torch.report.pdf.document import render_pdf
from greybox_torch.report.pdf.sheets import Sheets


@pytest.fixture
def printed(monkeypatch: pytest.MonkeyPatch, about: About) -> Callable[[Verdict], Sheets]:
    """The sheets of a verdict, which was printed."""
    made: list[Sheets] = []
    begin = paper.Sheets.__init__

    def noted(self: Sheets, foot: str) -> None:
        begin(self, foot)
        made.append(self)

    monkeypatch.setattr(paper.Sheets, "__init__", noted)

    def render(verdict: Verdict) -> Sheets:
        assert render_pdf(verdict, about).startswith(b"%PDF-1.")
        return made[-1]

    return render


def words(sheets: Sheets) -> str:
    found = " ".join(text.get_text() for figure in sheets.figures for text in figure.texts)
    return " ".join(found.split())


@pytest.mark.parametrize("kind", ["found", "nothing"])
def test_the_page_in_print(of_kind: Callable[[str], Verdict], printed: Callable[[Verdict], Sheets], kind: str) -> None:
    verdict = of_kind(kind)
    if kind == "found":
        verdict = replace(verdict, complete=False, beliefs=Beliefs({"gear_spring/*": 0.0}))
    sheets = printed(verdict)
    told = words(sheets)
    assert " ".join(verdict.sentence.split()) in told
    for part in (
        *verdict.evidence,
        "Measured and simulated",
        "Error by frequency",
        "Sweep <1>",
        "greybox compare",
        "Seed 7",
    ):
        assert part in told
    if verdict.effects:
        assert told.index("Before and after") < told.index("What is missing") < told.index("Evidence")
        for effect in verdict.effects:
            assert effect.explanation in told and effect.where in told and effect.source in told
        assert "half_gap 0.03100 ± 0.00040 rad" in told and "nonlinear stiffness at gear_spring" in told
        assert "The search was stopped before it was done." in told
        assert "any mechanism at gear_spring: excluded" in told
    else:
        assert "What could still hide" in told
    assert f"1 / {len(sheets.figures)}" in told and 2 <= len(sheets.figures) <= 8


def test_sheets_have_no_backticks(of_kind: Callable[[str], Verdict], printed: Callable[[Verdict], Sheets]) -> None:
    told = words(printed(replace(of_kind("found"), evidence=("Try `greybox fit`.",))))
    assert "Try greybox fit." in told and "`" not in told


def test_nothing_runs_off_a_sheet(of_kind: Callable[[str], Verdict], printed: Callable[[Verdict], Sheets]) -> None:
    verdict = of_kind("several")
    long = "W" * 300 + " and a name of " + "many words " * 30
    traces = tuple(replace(t, experiment=f"{long}{k}") for k, t in enumerate(verdict.traces))
    scores = {m: tuple(replace(s, experiment=long) for s in rows) for m, rows in verdict.scores.items()}
    sheets = printed(replace(verdict, traces=traces, scores=scores, dataset="a short name"))
    for figure in sheets.figures:
        figure.dpi = 288.0  # the picture's letters are rounded to its dots, those in print are not
        renderer = FigureCanvasAgg(figure).get_renderer()
        width, height = figure.bbox.width, figure.bbox.height
        for text in figure.texts:
            box = text.get_window_extent(renderer)
            assert 0.06 * width < box.x0 and box.x1 < 0.93 * width, text.get_text()
            assert box.y0 > 0.0 and box.y1 < height, text.get_text()
        for axes in figure.axes:
            box = axes.get_position()
            assert box.y0 > 0.03 and box.y1 < 0.95 and box.x0 > 0.05 and box.x1 < 0.95


def test_what_is_not_there_leaves_no_title(
    of_kind: Callable[[str], Verdict], printed: Callable[[Verdict], Sheets]
) -> None:
    verdict = of_kind("found")
    bare = replace(verdict.effects[0], curve=None, profiles=(), alternatives=(), separating_experiment="", source="")
    told = words(printed(replace(verdict, effects=(bare,), ranking=(), stages={}, evidence=(), traces=())))
    for absent in (
        "Evidence",
        "Measured and simulated",
        "What was considered",
        "What else",
        "Time by stage",
        "Error by frequency",
    ):
        assert absent not in told


def test_letters_that_the_font_does_not_have_warn_nobody(of_kind: Callable[[str], Verdict], about: About) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert render_pdf(replace(of_kind("nothing"), dataset="机器 $x$", traces=()), about)


def test_numbers_of_the_headline_stand_apart(
    of_kind: Callable[[str], Verdict], printed: Callable[[Verdict], Sheets]
) -> None:
    """With two outputs there are four of them."""
    verdict = of_kind("found")
    scores = {
        m: (*rows, *(replace(s, output="angle", rmse=1.234e-7) for s in rows)) for m, rows in verdict.scores.items()
    }
    first = printed(replace(verdict, scores=scores)).figures[0]
    first.dpi = 288.0
    renderer = FigureCanvasAgg(first).get_renderer()
    numbers = [text for text in first.texts if "→" in text.get_text() and text.get_fontweight() == "bold"]
    assert len(numbers) == 3
    for one, other in pairwise(number.get_window_extent(renderer) for number in numbers):
        assert one.x1 < other.x0


def test_lines_are_no_wider_than_their_place() -> None:
    lines = paper.broken("a few words, 99.4 %, and " + "x" * 200, 100.0, 10.0)
    assert all(paper.wide(line, 10.0) <= 100.0 for line in lines)
    assert "".join(lines).replace("\u00a0", "").replace(" ", "") == "afewwords,99.4%,and" + "x" * 200
    assert any("99.4\u00a0%" in line for line in lines)
    assert paper.broken("", 100.0, 10.0) == [""]
