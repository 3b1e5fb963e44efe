"""The report as a document: the answer and the table first, then pictures, evidence, and how it was made."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text
from greybox_torch.report.about import About
from greybox_torch.report.page import registered_sections
from greybox_torch.report.pdf.charts import COLOURS, draw_chart, height_of
from greybox_torch.report.pdf.effects import BARS, draw_effects, draw_facts, plain
from greybox_torch.report.pdf.own_sections import draw_own
from greybox_torch.report.pdf.sheets import MARGIN, QUIET, ROOM, SPACING, Sheets, broken, wide
from greybox_torch.report.pdf.tables import draw_bars, draw_table
from greybox_torch.report.sections.headline import Figure, Headline
from greybox_torch.report.sections.limits import Limits
from greybox_torch.report.sections.making import Making
from greybox_torch.report.sections.parameters import Parameters
from greybox_torch.report.sections.ranking import Ranking
from greybox_torch.report.sections.remains import Remains
from greybox_torch.report.sections.scores import Scores
from greybox_torch.report.sections.spectrum import Spectrum
from greybox_torch.report.sections.traces import Traces

OF_TRACES = 0.72
"""Height of the traces beside that of other pictures, so that two experiments stand on a sheet."""


def render_pdf(verdict: Verdict, about: About) -> bytes:
    """The sections of the page as PDF; of those that were registered by others, whose templates are HTML, the text."""
    sheets = Sheets(f"{verdict.dataset}: diagnosis with greybox_torch {about.version}")
    _headline(sheets, Headline.of(verdict))
    _scores(sheets, Scores.of(verdict, about))
    draw_effects(sheets, verdict)
    _parameters(sheets, Parameters.of(verdict))
    _remains(sheets, Remains.of(verdict))
    _limits(sheets, Limits.of(verdict))
    _traces(sheets, Traces.of(verdict))
    _list(sheets, "Evidence", verdict.evidence)
    _spectrum(sheets, Spectrum.of(verdict))
    _ranking(sheets, Ranking.of(verdict))
    for html in registered_sections(verdict, about):
        draw_own(sheets, html)
    _making(sheets, Making.of(verdict, about))
    made = about.created
    return sheets.printed({"Title": f"{verdict.dataset}: diagnosis", "Creator": "greybox_torch", "CreationDate": made})


def _list(sheets: Sheets, title: str, sentences: tuple[str, ...]) -> None:
    if sentences:
        sheets.title(title)
    for sentence in sentences:
        sheets.text(sentence, indent=10.0, bullet="•")
        sheets.gap(2.0)


def _headline(sheets: Sheets, told: Headline) -> None:
    sheets.rule(colour=BARS["chosen"], thick=2.5)
    sheets.top += 12.0
    sheets.text(f"Diagnosis of {told.dataset} with the model {told.model}", colour=QUIET)
    sheets.gap(4.0)
    sheets.text(told.sentence, 17.0, bold=True)
    sheets.gap(8.0)
    if not told.complete:
        cut = "The search was stopped before it was done. This is the best that it had found by then."
        sheets.text(" ".join((cut, *told.not_tried)), colour=BARS["chosen"])
        sheets.gap(8.0)
    for sentence in told.beside:
        sheets.text(sentence)
        sheets.gap(8.0)
    beside = 4 if len(told.figures) == 4 else 3
    for k in range(0, len(told.figures), beside):
        _figures(sheets, told.figures[k : k + beside], ROOM / beside)


def _figures(sheets: Sheets, figures: Sequence[Figure], width: float) -> None:
    """Numbers beside each other."""
    lines = [(broken(f.label, width - 10.0, 8.0), broken(f.note, width - 10.0, 7.5)) for f in figures]
    labels, notes = (max(len(one[i]) for one in lines) for i in (0, 1))
    height = SPACING * (8.0 * labels + 13.0 + 7.5 * notes) + 8.0
    sheets.need(height)
    for k, (figure, (label, note)) in enumerate(zip(figures, lines, strict=True)):
        x, y = MARGIN + k * width, sheets.top
        for i, line in enumerate(label):
            sheets.write(line, x, y + SPACING * 8.0 * i, 8.0, colour=QUIET)
        y += SPACING * 8.0 * labels
        shown = f"{figure.before} → {figure.after}" if figure.before else figure.after
        size = min(12.0, 12.0 * (width - 10.0) / wide(shown, 12.0, bold=True))
        sheets.write(shown, x, y, size, bold=True)
        for i, line in enumerate(note):
            sheets.write(line, x, y + SPACING * (13.0 + 7.5 * i), 7.5, colour=QUIET)
    sheets.top += height


def _scores(sheets: Sheets, told: Scores) -> None:
    sheets.title("Before and after" if len(told.columns) == 3 else "How well the model fits")
    sheets.text(
        "Fit in free run over the whole experiment, 100 (1 − ‖y − ŷ‖ / ‖y − ȳ‖), and root mean square error.",
        8.0,
        colour=QUIET,
    )
    share = 0.19 * 3 / len(told.columns) if len(told.columns) > 3 else 0.19
    widths = [1.0 - share * len(told.columns), *[share] * len(told.columns)]
    draw_table(sheets, [("Experiment", ""), *told.columns], [], widths)
    for group in told.groups:
        sheets.need(50.0)
        sheets.gap(3.0)
        sheets.text(group.title, 8.0, colour=QUIET)
        rows = [[(row.experiment, row.output), *((c.fit, c.error) for c in row.cells)] for row in group.rows]
        draw_table(sheets, (), rows, widths, bold_last=True)
    if told.begun:
        sheets.gap(3.0)
        sheets.text(told.begun, 8.0, colour=QUIET)
    if told.held_out_by_default:
        sheets.gap(3.0)
        sheets.text(
            "The card gives no experiment the role “validation”: the last quarter of each was held out.",
            8.0,
            colour=QUIET,
        )


def _parameters(sheets: Sheets, told: Parameters | None) -> None:
    if told is None:
        return
    sheets.title("The model's own parameters", 120.0)
    sheets.text("All that are free, ± one standard deviation.", 8.0, colour=QUIET)
    if told.undetermined:
        larger = "Where the standard deviation exceeds the value, these recordings do not determine the parameter in that model."
        sheets.text(larger, 8.0, colour=QUIET)
    if told.bounded:
        sheets.text(told.bounded, 8.0, colour=QUIET)
    rows = [[(plain(row.symbol), row.unit), *((value, "") for value in row.values)] for row in told.rows]
    share = 0.78 / len(told.columns)
    draw_table(sheets, [("Parameter", ""), *told.columns], rows, [0.22, *[share] * len(told.columns)], bold_last=True)


def _remains(sheets: Sheets, told: Remains | None) -> None:
    if told is None:
        return
    sheets.title("What remains")
    sheets.text(told.sentence)
    rows = [[(f"{row.mechanism} at {row.port}", ""), (row.size, "")] for row in told.refinements]
    if rows:
        draw_table(sheets, [("Refinement", "no finding rests on it"), ("Share of the mismatch", "")], rows, [0.7, 0.3])
    for row in told.refinements:
        sheets.text(f"{text.first_capital(row.mechanism)} at {row.port}: {row.why}.", 8.0, colour=QUIET)


def _limits(sheets: Sheets, told: Limits | None) -> None:
    if told is None:
        return
    sheets.title("What could still hide, and what would show it")
    for sentence in told.sentences:
        sheets.text(sentence)
        sheets.gap(3.0)
    for one in told.suggestions:
        sheets.text(f"{one.experiment} ({one.mechanism} at {one.port})", indent=10.0, bullet="•")


def _traces(sheets: Sheets, told: Traces | None) -> None:
    if told is None:
        return
    sheets.title("Measured and simulated", 50.0 + height_of(told.charts[0].chart, OF_TRACES))
    left_out = (
        f" Drawn are those whose error was largest; {told.left_out} more are in the table only."
        if told.left_out
        else ""
    )
    sheets.text(
        f"Validation experiments, each simulated in one go from its initial state.{left_out}", 8.0, colour=QUIET
    )
    for one in told.charts:
        sheets.gap(6.0)
        sheets.need(SPACING * 10.5 + height_of(one.chart, OF_TRACES))
        sheets.text(one.title, 10.5, bold=True)
        sheets.gap(3.0)
        draw_chart(sheets, one.chart, OF_TRACES)


def _spectrum(sheets: Sheets, told: Spectrum | None) -> None:
    if told is not None:
        sheets.title("Error by frequency", 240.0)
        draw_chart(sheets, told.chart)


def _ranking(sheets: Sheets, told: Ranking | None) -> None:
    if told is None:
        return
    sheets.title("What was considered" if told.mismatch else "What was tried", 120.0)
    sheets.text(
        "Share of the squared error that each would explain in the screen, and what its refit really removed.",
        8.0,
        colour=QUIET,
    )
    heads = [("Hypothesis", ""), ("Explains in the screen", ""), ("Removed by a refit", "")]
    rows = [
        [
            (f"{row.mechanism} at {row.port}{', chosen' if row.chosen else ''}", ""),
            (row.explained, ""),
            (row.removed, ""),
        ]
        for row in told.rows
    ]
    draw_table(sheets, heads, rows, [0.5, 0.25, 0.25])
    if told.passed_over:
        sheets.text(told.passed_over, 8.0, colour=QUIET)


def _making(sheets: Sheets, told: Making) -> None:
    sheets.title("The model, and how this came about", 120.0)
    if told.command:
        sheets.text("The model as it is now lies beside this document as a checkpoint. To simulate with it:")
        sheets.text(told.command, 8.5, indent=10.0)
        sheets.gap(6.0)
    draw_facts(sheets, [(name, value) for name, value in told.facts])
    _list(
        sheets,
        "Known beforehand",
        tuple(f"{b.mechanism or 'any mechanism'} at {b.port or 'any port'}: {b.said}" for b in told.beliefs),
    )
    if told.stages:
        sheets.title("Time by stage")
        draw_bars(sheets, [(s.name, s.length / 100.0, s.seconds, COLOURS["measured"]) for s in told.stages])
    changed = ", ".join(f"{text.words(r.name)} is {r.value} instead of {r.default}" for r in told.changed)
    sheets.title("Settings", 40.0)
    sheets.text(f"Changed: {changed}." if changed else f"All {len(told.settings)} are at their default.")
    if told.values:
        sheets.title("All parameter values")
        rows = [[(plain(v.name), v.owner), (f"{v.value} {v.unit}".strip(), "")] for v in told.values]
        draw_table(sheets, (), rows, [0.6, 0.4])
