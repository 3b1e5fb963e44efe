from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from greybox_torch.diagnosis.effect import Timeline
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page

VOID = {"meta", "br", "hr", "img", "input", "link", "path"}


class Page(HTMLParser):
    """Every element with its attributes, in order; refuses elements that are not closed in the order they were opened."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.texts: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in VOID
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open[-1] == tag, f"</{tag}> closes <{self.open[-1:]}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        if not {"style", "script"} & set(self.open):
            self.texts.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]

    @property
    def ids(self) -> list[str | None]:
        return [attributes["id"] for _, attributes in self.elements if "id" in attributes]

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.texts).split())


def without_samples(html: str) -> str:
    """The page without the samples that it carries, in which any letters may stand."""
    return re.sub(r'<script type="application/json" class="samples">.*?</script>', "", html)


def test_whole_and_needs_nothing_else(verdict: Verdict, about: About) -> None:
    html = render_page(verdict, about)
    page = Page(html)
    assert html.startswith("<!doctype html>")
    assert page.all("html") == [{"lang": "en"}]
    assert len(page.all("h1")) == 1
    assert {"width=device-width, initial-scale=1"} <= {m.get("content") for m in page.all("meta")}
    assert "prefers-color-scheme: dark" in html
    for tag in ("link", "img", "iframe", "object"):
        assert page.all(tag) == []
    assert all("src" not in script for script in page.all("script"))
    told = without_samples(html)
    assert not re.search(r"(src|href|url|@import)\s*[=(]", told)
    assert "http" not in told and "fetch(" not in told and "import(" not in told
    assert len(html) < 3_000_000
    assert len(page.ids) == len(set(page.ids))


@pytest.mark.parametrize(
    ("kind", "sections"),
    [
        ("found", ["found", "evidence", "fit", "traces", "spectrum", "ranking", "making"]),
        ("several", ["found", "evidence", "fit", "traces", "spectrum", "ranking", "making"]),
        ("unknown", ["found", "evidence", "fit", "traces", "spectrum", "ranking", "making"]),
        ("nothing", ["evidence", "fit", "limits", "traces", "spectrum", "ranking", "making"]),
    ],
)
def test_sections(of_kind: Callable[[str], Verdict], about: About, kind: str, sections: list[str]) -> None:
    verdict = of_kind(kind)
    page = Page(render_page(verdict, about))
    assert page.ids == sections
    assert verdict.sentence in page.text
    for sentence in verdict.evidence:
        assert sentence in page.text


def test_a_search_that_was_stopped(verdict: Verdict, about: About) -> None:
    told = "The search was stopped before it was done."
    assert told not in Page(render_page(verdict, about)).text
    stopped = replace(verdict, complete=False)
    text = Page(render_page(stopped, about)).text
    text = text[: text.index("Settings")]  # one of which is called confidence
    assert told in text
    assert ("no answer yet" in text) == (not verdict.mismatch)
    assert ("Confidence" in text) == verdict.mismatch


def test_an_experiment_that_no_longer_judges_is_told_at_the_top(verdict: Verdict, about: About) -> None:
    told = "Steps no longer counts as validation: it was taken to choose with as well (the evidence says why)."
    text = Page(render_page(replace(verdict, no_longer_validation=(told,)), about)).text
    assert text.index(verdict.sentence) < text.index(told) < text.index("Validation fit")


def test_an_error_that_nothing_explains(of_kind: Callable[[str], Verdict], about: About) -> None:
    """Something is missing, and there is no model with effects to compare with."""
    unexplained = replace(of_kind("nothing"), unexplained=12.0)
    text = Page(render_page(unexplained, about)).text
    assert "Something is missing" in text and "12 times the noise" in text and "that something is missing" in text
    assert "Nothing is missing" not in text and "search says that was stopped" not in text
    assert (
        "as far as a search says that was stopped"
        in Page(render_page(replace(unexplained, complete=False), about)).text
    )


def test_every_picture_is_told_in_words(verdict: Verdict, about: About) -> None:
    page = Page(render_page(verdict, about))
    pictures = page.all("svg")
    assert len(pictures) >= 5
    for picture in pictures:
        assert picture["role"] == "img"
        label = picture["aria-label"]
        assert label is not None and len(label) > 30 and label.endswith(".")
    assert len(page.all("figcaption")) == len(page.all("figure"))


def test_names_of_the_user_are_text(of_kind: Callable[[str], Verdict], about: About) -> None:
    html = render_page(of_kind("found"), about)
    assert "Sweep &lt;1&gt;" in html
    assert "Sweep <1>" not in html
    assert "Arm &amp; drive" in html


def test_what_stands_between_backticks_is_set_as_code(of_kind: Callable[[str], Verdict], about: About) -> None:
    """Seen: raw backticks in the report, of sentences that terminals show as well."""
    verdict = of_kind("found")
    html = render_page(replace(verdict, evidence=(*verdict.evidence, "Try `greybox fit <card>`, or one `.")), about)
    assert "Try <code>greybox fit &lt;card&gt;</code>, or one `." in html
    assert "`" not in Page(html).text.replace("or one `", "")


def test_how_it_was_made(of_kind: Callable[[str], Verdict], about: About) -> None:
    text = Page(render_page(of_kind("found"), about)).text
    for told in ("greybox_torch 1.2.3", "2026-11-20 06:00 UTC", "Seed 7", "42 s", "screen 40 s", "robot_arm"):
        assert told in text
    assert "greybox compare dataset.toml results/arm/model" in text
    assert "half_gap gear spring: backlash 0.031000 rad" in text


def test_share_of_the_ceiling(of_kind: Callable[[str], Verdict], about: About) -> None:
    verdict = of_kind("found")
    assert "of what the best free curve" not in Page(render_page(verdict, about)).text
    near = replace(verdict, effects=(replace(verdict.effects[0], ceiling=0.88),))
    assert "Form 88 % of what the best free curve in the law's place improves" in Page(render_page(near, about)).text


def test_where_along_the_experiments(of_kind: Callable[[str], Verdict], about: About) -> None:
    verdict = of_kind("found")
    line = Timeline("Sweep <1>", np.array([0.0, 1.5, 3.0]), np.array([0.25, 0.75]))
    page = Page(render_page(replace(verdict, effects=(replace(verdict.effects[0], timelines=(line,)),)), about))
    assert len(page.all("figure")) == len(Page(render_page(verdict, about)).all("figure")) + 1
    assert "When: how the error energy that the effect explains spreads" in page.text


def test_a_simulation_that_overflowed(of_kind: Callable[[str], Verdict], about: About) -> None:
    """The start values' run is not drawn, but its row is there; a refit that ran away does not stretch the axes."""
    verdict = of_kind("found")
    broken = np.where(verdict.traces[1].time > 1.0, np.inf, 0.0)
    wild = np.where(verdict.traces[1].time > 2.0, 1e200, verdict.traces[1].refit)
    traces = (verdict.traces[0], replace(verdict.traces[1], start=broken, refit=wild))
    lost = tuple(Score(s.experiment, s.role, s.output, -np.inf, np.inf) for s in verdict.scores["start"])
    html = render_page(replace(verdict, traces=traces, scores={**verdict.scores, "start": lost}), about)
    assert "overflow" in Page(html).text
    told = without_samples(html)
    assert "nan" not in re.sub(r"<title>.*?</title>", "", told.split("<script>")[0])
    assert "10²⁰⁰" not in told.split('id="traces"')[1].split('id="spectrum"')[0].replace("root mean square", "")


def test_many_experiments(with_traces: Callable[..., Verdict], about: About) -> None:
    rows = [(f"Run {k:02d}", "validation", 0.1 + 0.01 * k, 200_00) for k in range(20)]
    html = render_page(with_traces(("Steps", "estimation", 1.0), *rows), about)
    page = Page(html)
    assert len(html) < 3_000_000
    assert "8 more are in the table only" in page.text
    assert len(page.all("figure")) == 2 + 12 + 1
    for name, *_ in rows:
        assert name in page.text


def test_without_stages_ranking_or_curve(of_kind: Callable[[str], Verdict], about: About) -> None:
    """What is not there leaves no empty frame."""
    verdict = of_kind("found")
    bare = replace(verdict.effects[0], curve=None, profiles=(), alternatives=(), separating_experiment="", source="")
    verdict = replace(verdict, effects=(bare,), ranking=(), stages={}, evidence=(), traces=())
    page = Page(render_page(verdict, replace(about, values=None, units=None, command="")))
    assert page.ids == ["found", "fit", "making"]
    assert page.all("figure") == []
    for absent in ("What else", "Source", "Time by stage", "checkpoint"):
        assert absent not in page.text


def test_held_out_by_default(of_kind: Callable[[str], Verdict], about: About) -> None:
    told = "the last quarter of each was held out"
    assert told not in Page(render_page(of_kind("found"), about)).text
    assert told in Page(render_page(of_kind("found"), replace(about, held_out_by_default=True))).text
