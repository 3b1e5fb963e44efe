"""What is missing, effect by effect, on a sheet."""

from __future__ import annotations

import re

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.pdf.charts import draw_chart
from greybox_torch.report.pdf.sheets import MARGIN, QUIET, SPACING, Sheets
from greybox_torch.report.pdf.tables import draw_bars, draw_table
from greybox_torch.report.sections.effects import OF_A_CURVE, Card, Effects, Share

BARS = {"chosen": "#0868b0", "together": "#84b3d7", "other": "#8b939c"}


def draw_effects(sheets: Sheets, verdict: Verdict) -> None:
    told = Effects.of(verdict)
    if told is None:
        return
    sheets.title("What is missing", 200.0)
    for card in told.cards:
        _card(sheets, card)
        sheets.gap(10.0)
    for sentence in told.about_sizes:
        sheets.text(sentence, 8.0, colour=QUIET)
        sheets.gap(4.0)


def _card(sheets: Sheets, card: Card) -> None:
    sheets.need(140.0)
    name = card.statement or f"{card.title} at {card.port}"
    sheets.text(f"{name} (probability {card.probability:.2f})", 11.0, bold=True)
    if card.statement:
        likely = f"The likeliest is {card.title.lower()} at {card.port}, and the model has that one."
        sheets.text(f"{card.alike} {likely}")
    sheets.text(card.explanation)
    sheets.gap(4.0)
    rows = [[(plain(row.symbol), row.description), (f"{row.value} {row.unit}".strip(), "")] for row in card.parameters]
    if rows:
        draw_table(sheets, [("Parameter of its law", ""), ("± one standard deviation", "")], rows, [0.5, 0.5])
        sheets.gap(6.0)
    for told in filter(None, (card.bounded, card.remarks)):
        sheets.text(f"{told}.", 8.0, colour=QUIET)
        sheets.gap(4.0)
    facts = [("Law", card.equation)] if card.equation else []
    windows = "over windows whose start states are estimated"
    brought = f"left out, it brings back {card.size} of the error of the model without effects, {windows}"
    facts += [("Size", brought)] if card.size else []
    explained = f"{card.explained} of the mismatch in free runs of the validation experiments"
    facts += [("Explains", explained)] if card.explained else []
    facts += [("Form", f"{card.ceiling} {OF_A_CURVE}")] if card.ceiling else []
    facts += [("Where", card.where)] if card.where else []
    facts += [("Depends on", ", ".join(card.signals))] if card.signals else []
    facts += [("Source", card.source)] if card.source else []
    draw_facts(sheets, facts)
    if card.shares:
        sheets.gap(6.0)
        sheets.need(60.0)
        sheets.text("What it could be" if card.statement else "What else it could be", 9.5, bold=True)
        draw_bars(sheets, [_share(share) for share in card.shares])
    if card.one_effect:
        sheets.gap(3.0)
        sheets.text(f"{card.one_effect}.")
    if card.experiment:
        sheets.gap(3.0)
        sheets.text(f"{card.experiment_tells}: {card.experiment}.")
    sheets.gap(8.0)
    for chart in (*card.curves, *(card.responses.charts if card.responses else ()), card.profiles, card.timelines):
        if chart is not None:
            draw_chart(sheets, chart)
    if card.responses and card.responses.note:
        sheets.text(card.responses.note, 8.0, colour=QUIET)


def _share(share: Share) -> tuple[str, float, str, str]:
    kind = "chosen" if share.chosen else "together" if share.together else "other"
    name = f"{share.mechanism} at {share.port}" if share.port else share.mechanism
    name += f" ({share.value})" if share.value else ""
    return name, share.probability, f"{share.probability:.2f}", BARS[kind]


def draw_facts(sheets: Sheets, facts: list[tuple[str, str]]) -> None:
    """Names in a narrow column, and what is said of them."""
    for name, said in facts:
        sheets.need(SPACING * 9.5)
        sheets.write(name, MARGIN, sheets.top, 9.5, colour=QUIET)
        for line in said.split("\n"):
            sheets.text(line.strip(), indent=90.0 if line.startswith(" ") else 80.0)


def plain(symbol: object) -> str:
    """A symbol without the page's tags; an index stands behind an underscore."""
    return re.sub(r"<[^>]+>", "", re.sub(r"<sub>(.*?)</sub>", r"_\1", str(symbol)))
