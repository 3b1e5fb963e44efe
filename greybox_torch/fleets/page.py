"""The fleet's page: one HTML file that needs nothing else, with links to the reports of the single data sets."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from greybox_torch import __version__
from greybox_torch.fleets.change_points import FEWEST
from greybox_torch.fleets.charts import change_sentences, history_chart
from greybox_torch.fleets.history import History
from greybox_torch.fleets.in_common import Group
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.suggested_beliefs import SuggestedBeliefs
from greybox_torch.report import text
from greybox_torch.report.chart.panel import Chart

PAGE = "fleet.html"
MOST_ROWS = 5000
"""Rows of the page; more are in the other files. A browser sorts so many in a blink."""
MOST_STANDING_OUT = 12
"""Changes and outliers that the top of the page tells."""
MOST_HISTORIES = 60
"""Machines whose course over time the page draws, those that changed first."""

ANSWER_WORDS = {
    "named": "an effect with a name",
    "unknown": "an unknown effect",
    "missing": "something without a name",
    "nothing": "nothing missing",
    "unfinished": "no answer yet",
    "failed": "failed",
}
FAILURE_WORDS = {
    "input": "input at fault",
    "numbers": "numbers failed",
    "memory": "out of memory",
    "killed": "ended its process",
    "error": "unexpected error",
}


@dataclass(frozen=True)
class Line:
    """A row as the page prints it: texts, and the values to sort by."""

    row: Row
    tag: str
    answer: str
    verdict: str
    detail: str
    how_sure: str
    parameter: str
    before: str
    after: str
    seconds: str


@dataclass(frozen=True)
class Course:
    """A machine over time."""

    machine: str
    anchor: str
    sentences: list[str]
    otherwise: str
    chart: Chart


def told_as(row: Row) -> str:
    """The answer of a row, an unknown effect set apart from what is only known to be missing: one of :data:`ANSWER_WORDS`."""
    return "missing" if row.answer == "unknown" and not row.effect else row.answer


def counted(rows: Iterable[Row]) -> list[tuple[str, str, int]]:
    """How many rows came to which answer, and that in words, in the order in which they are told."""
    counts = Counter(told_as(row) for row in rows)
    return [(answer, words, counts[answer]) for answer, words in ANSWER_WORDS.items() if counts[answer]]


def render_fleet(
    rows: Sequence[Row],
    common: Sequence[Group],
    courses: Sequence[History],
    *,
    suggested: Sequence[SuggestedBeliefs] = (),
    waiting: int = 0,
) -> str:
    """The page as HTML text.

    Args:
        suggested: what is said of in the files beside the page.
        waiting: data sets that no worker has had yet, where the run was stopped.
    """
    counts = Counter(row.answer for row in rows)
    drawn = [
        Course(c.machine, f"course-{k}", change_sentences(c), _unchanged(c), history_chart(c))
        for k, c in enumerate(courses[:MOST_HISTORIES])
    ]
    return _environment().get_template("fleet.html.j2").render(
        version=__version__,
        lines=[_line(row) for row in rows[:MOST_ROWS]],
        left_out=max(0, len(rows) - MOST_ROWS),
        counts=counted(rows),
        headline=_headline(rows, courses, counts),
        dated=any(row.recorded for row in rows),
        waiting=waiting,
        groups=[_group(group) for group in common],
        suggested=suggested,
        courses=drawn,
        standing_out=_standing_out(drawn, common),
        more_courses=max(0, len(courses) - MOST_HISTORIES),
        seconds=text.seconds(sum(row.seconds for row in rows)),
    )  # fmt: skip


def _headline(rows: Sequence[Row], courses: Sequence[History], counts: Counter[str]) -> str:
    # of a card that cannot be read no machine is known
    machines = len({row.machine for row in rows if row.card_read})
    missing = len({row.machine for row in rows if row.answer in ("named", "unknown")})
    parts = [f"{machines} machine{'s' * (machines != 1)}: in {missing} something is missing from the model"]
    tested = [c for c in courses if c.tested]
    if tested:
        parts.append(f"{sum(c.changed for c in tested)} of {len(tested)} recorded over time changed")
    if counts["unfinished"]:
        parts.append(f"{counts['unfinished']} data set{'s' * (counts['unfinished'] != 1)} without an answer yet")
    if counts["failed"]:
        parts.append(f"{counts['failed']} data set{'s' * (counts['failed'] != 1)} failed")
    return "; ".join(parts) + "."


def _unchanged(history: History) -> str:
    """What is said of a machine of which no change is told."""
    if history.tested:
        return "No change that is more than chance."
    return f"{len(history.rows)} dated verdicts are too few to tell a change from chance; {FEWEST} are needed."


def _standing_out(courses: Sequence[Course], common: Sequence[Group]) -> list[tuple[str, str, str]]:
    """Machines that changed or are unlike the others: name, sentence, and where on the page more is said."""
    changed = [(course.machine, sentence, course.anchor) for course in courses for sentence in course.sentences]
    unlike = [
        (row.machine, f"{group.name} is {text.number(residual, 2)} deviations from what the others say.", "in-common")
        for group in common
        for row, _, residual in group.outliers
    ]
    return [*changed, *unlike][:MOST_STANDING_OUT]


def _line(row: Row) -> Line:
    sure = row.probability if row.effect else row.confidence
    fits = [value for value in (row.fit_before, row.fit_after) if value is not None]
    digits = 2 if any(value > 99 for value in fits) else 1
    before, after = ("" if v is None else text.fit(v, digits) for v in (row.fit_before, row.fit_after))
    value = "" if row.value is None else text.with_unit(text.measured(row.value, row.std), row.unit)
    return Line(
        row=row,
        tag=FAILURE_WORDS.get(row.failure, "failed") if row.failed else ANSWER_WORDS[told_as(row)],
        answer=told_as(row),
        verdict=text.first_capital(row.effect) or text.first_capital(ANSWER_WORDS[told_as(row)]),
        detail=row.message if row.failed else row.sentence,
        how_sure="" if sure is None or row.answer in ("failed", "unfinished") else f"{sure:.2f}",
        parameter=f"{row.parameter} = {value}" if value else "",
        before="" if row.answer == "nothing" else before,
        after=after,
        seconds="under 0.1" if row.seconds < 0.1 else text.number(row.seconds, 3 if row.seconds >= 10 else 2),
    )


def _group(group: Group) -> dict[str, Any]:
    estimate = group.estimate
    unit = text.unit(group.unit)
    return {
        "title": text.first_capital(group.effect),
        "parameter": group.parameter.rpartition(".")[2],
        "model": group.model,
        "count": len(group.rows),
        "of": group.of,
        "mean": text.with_unit(text.measured(estimate.mean, estimate.std), group.unit),
        "between": text.with_unit(text.number(estimate.between), group.unit),
        "outliers": [
            {
                "machine": row.machine,
                "report": row.report,
                "value": text.measured(row.value or 0.0, row.std),
                "shrunken": text.number(value),
                "residual": text.number(residual, 2),
                "unit": unit,
            }
            for row, value, residual in group.outliers
        ],
    }


def _environment() -> Environment:
    environment = Environment(
        loader=ChoiceLoader([PackageLoader("greybox_torch.fleets"), PackageLoader("greybox_torch.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"words": text.words, "prose": text.prose}
    return environment
