"""The traces: what is drawn, and that a reader can look closer in a browser, with all channels of an experiment together."""

from __future__ import annotations

import html as escapes
import re
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.diagnosis.traces import InputTrace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page
from greybox_torch.report.sections.traces import MOST_INPUTS, Traces
from tests.browser import after_scripts, needs_browser


def with_inputs(verdict: Verdict, count: int = 1) -> Verdict:
    """With voltages in every experiment, the k-th a sine of k + 1 Hz."""
    experiments = {t.experiment: t.time for t in verdict.traces}
    inputs = [
        InputTrace(experiment, f"voltage_{k}", "V", time, np.sin(2 * np.pi * (k + 1) * time))
        for experiment, time in experiments.items()
        for k in range(count)
    ]
    return replace(verdict, inputs=tuple(inputs))


def drawn(verdict: Verdict) -> Traces:
    found = Traces.of(verdict)
    assert found is not None
    return found


def test_inputs_stand_beneath_the_first_output(with_traces: Callable[..., Verdict]) -> None:
    verdict = with_traces(("A", "validation", 1.0), ("B", "validation", 1.0))
    verdict = replace(verdict, traces=(*verdict.traces, replace(verdict.traces[0], output="angle")))
    first, second, third = (one.chart.columns for one in drawn(with_inputs(verdict, 3)).charts)
    labels = [[panel.y_label for panel in columns[0]] for columns in (first, second, third)]
    assert [label.split(" [")[0] for label in labels[0]] == ["motor speed", "error", "voltage 0", "voltage 1"]
    assert len(labels[0]) == len(labels[1]) == 2 + MOST_INPUTS and len(labels[2]) == 2
    assert [panel.x_label for panel in first[0]] == ["", "", "", "time [s]"]
    assert [panel.x_label for panel in third[0]] == ["", "time [s]"]
    told = [one.chart.caption for one in drawn(with_inputs(verdict, 3)).charts]
    assert told[0].endswith(" Not drawn of the inputs: voltage 2."), "seen: an input that is not drawn, and not a word"
    assert (
        told[2].endswith(" Inputs are drawn under A: motor speed.")
        and "nputs" not in drawn(verdict).charts[0].chart.caption
    )


def test_only_the_whole_record_can_be_looked_closer_at(with_traces: Callable[..., Verdict]) -> None:
    (one,) = drawn(with_inputs(with_traces(("A", "validation", 1.0)))).charts
    whole, detail = one.chart.columns
    assert [panel.live.lines for panel in whole if panel.live] == [
        "measured:measured before:before after:after",
        "before:error_before after:error_after",
        "input:input_0",
    ]
    assert all(panel.live is None for panel in detail)


def test_the_detail_is_where_the_recommended_model_is_worst(with_traces: Callable[..., Verdict]) -> None:
    """Seen: 0.3 s in which the error was nil, as the model without effects was worst there; 0.15 m at 6 s were not shown."""
    verdict = with_traces(("A", "validation", 1.0))
    (trace,) = verdict.traces
    count = len(trace.time)
    early, late = (np.arange(count) < count // 10), (np.arange(count) >= count - count // 20)
    worse = replace(trace, refit=trace.measured - 5.0 * early, augmented=trace.measured - 1.0 * late)
    (one,) = drawn(replace(verdict, traces=(worse,))).charts
    detail = one.chart.columns[1][0]
    assert detail.title == "detail where the error after is largest"
    assert detail.x.low > trace.time[count // 2]
    plain = drawn(replace(verdict, traces=(worse,), effects=())).charts[0].chart.columns[1][0]
    assert plain.title == "detail where the error is largest" and plain.x.high < trace.time[count // 2]


def test_held_inputs_are_steps(with_traces: Callable[..., Verdict], about: About) -> None:
    verdict = with_inputs(with_traces(("A", "validation", 1.0)))
    held = replace(verdict, inputs=tuple(replace(one, held=True) for one in verdict.inputs))
    sizes = []
    for data in (verdict, held):
        detail = drawn(data).charts[0].chart.columns[1]
        sizes.append([panel.marks[-1].path.count("L") for panel in detail])
    assert sizes[1] == [*sizes[0][:2], 2 * sizes[0][2]]
    assert [render_page(data, about).count('data-held="1"') for data in (verdict, held)] == [0, 1]


@needs_browser
def test_held_inputs_are_steps_when_looked_closer_at(
    with_traces: Callable[..., Verdict], about: About, tmp_path: Path
) -> None:
    verdict = with_inputs(with_traces(("A", "validation", 1.0)))
    held = replace(verdict, inputs=tuple(replace(one, held=True) for one in verdict.inputs))
    (tmp_path / "report.html").write_text(
        render_page(held, about).replace("</body>", '<script>location.hash = "#time=0,0.3,0.6";</script></body>'),
        encoding="utf-8",
    )
    _, document = after_scripts(tmp_path / "report.html", tmp_path, "--virtual-time-budget=5000")
    (path,) = re.findall(r'class="line input" d="(M[^"]*)"', document)[:1]
    places = [tuple(map(int, place.split())) for place in re.split("[ML]", path)[1:]]
    assert all(a[0] == b[0] or a[1] == b[1] for a, b in pairwise(places))


def test_a_million_samples(with_traces: Callable[..., Verdict], about: About) -> None:
    verdict = with_inputs(with_traces(("A", "validation", 1.0, 1_000_000)))
    assert len(render_page(verdict, about)) < 2_500_000


def test_a_run_that_overflows_leaves_no_trace_of_it(with_traces: Callable[..., Verdict], about: About) -> None:
    verdict = with_traces(("A", "validation", 1.0))
    wild = np.where(verdict.traces[0].time > 1.0, np.inf, verdict.traces[0].refit)
    assert (
        "Infinity"
        not in render_page(replace(verdict, traces=(replace(verdict.traces[0], refit=wild),)), about).split("<script>")[
            0
        ]
    )


def paths(panel: str) -> list[str]:
    """What is drawn in a panel."""
    return re.findall(r' d="([^"]*)"', panel)


STEPS = """
<script>
const plot = document.querySelector(".panel[data-lines] .plot"), box = plot.getBoundingClientRect(), told = [];
const note = () => told.push([...document.querySelectorAll(".zoom output")].map((o) => o.textContent).join("|"));
const press = (name) => document.querySelector(`.zoom button[aria-label="${name}"]`).click();
const at = (kind, share) => plot.dispatchEvent(new PointerEvent(kind, { clientX: box.left + share * box.width, button: 0 }));
at("pointerdown", 0.25); at("pointermove", 0.5); at("pointerup", 0.75); note();
press("Closer"); note();
press("Later"); note();
press("Farther"); note();
press("Whole record"); note();
press("Closer"); plot.dispatchEvent(new MouseEvent("dblclick")); note();
at("pointerdown", 0.5); at("pointerup", 0.501); note();
location.hash = "#time=0,0.3,0.6";
setTimeout(() => {
  note();
  document.title = told.join(" / ");
}, 200);
</script>
"""


@needs_browser
def test_in_a_browser(with_traces: Callable[..., Verdict], about: About, tmp_path: Path) -> None:
    """Dragged, moved by buttons, set back, and by the address: two outputs of one experiment together, another one not."""
    verdict = with_traces(("A", "validation", 1.0), ("B", "validation", 0.9))
    verdict = replace(verdict, traces=(*verdict.traces, replace(verdict.traces[0], output="angle")))
    page = tmp_path / "report.html"
    still = render_page(with_inputs(verdict), about)
    page.write_text(still.replace("</body>", f"{STEPS}</body>"), encoding="utf-8")
    title, document = after_scripts(page, tmp_path, "--virtual-time-budget=5000")
    told = [one.split("|") for one in escapes.unescape(title).split(" / ")]
    assert all(first == third and second == "" for first, second, third in told)
    stretches = [tuple(map(float, first.removesuffix(" s").split(" to "))) if first else None for first, *_ in told]
    # 2.999 s: a quarter to three quarters of it, half of that, half of it later, twice as long; the whole three times; the address
    shares = [(0.25, 0.75), (0.375, 0.625), (0.5, 0.75), (0.375, 0.875), None, None, None, (0.3 / 2.999, 0.6 / 2.999)]
    for found, share in zip(stretches, shares, strict=True):
        assert found == (None if share is None else pytest.approx((2.999 * share[0], 2.999 * share[1]), abs=1e-3))
    panels = re.findall(r'<div class="panel \w+" data-lines.*?</svg>', document, re.DOTALL)
    before = re.findall(r'<div class="panel \w+" data-lines.*?</svg>', still, re.DOTALL)
    moved = [paths(p) != paths(q) for p, q in zip(panels, before, strict=True)]
    assert moved == [True] * 3 + [False] * 3 + [True] * 2
    measured = re.search(r'class="line measured" d="M(-?\d+) ', panels[0])
    assert measured is not None and -100 < int(measured[1]) <= 0  # one sample before the stretch
    assert panels[0].count("L") > 250  # 0.3 s, a sample a millisecond
