"""The comparison as a table on the terminal, as Markdown, and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from experiments.speed.row import Entry, Row, Target
from greybox_torch.files import json_text, write_text

COLUMNS = ("measurement", "time", "compile", "remarks")


def print_header(console: Console, header: dict[str, str]) -> None:
    for name, value in header.items():
        console.print(f"{name:>15}  {value}", highlight=False, markup=False)
    console.print()


def print_row(console: Console, row: Row) -> None:
    """One row: its rivals, its targets, how the results agree."""
    table = Table(title=row.title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for name in COLUMNS:
        table.add_column(name, justify="right" if name in ("time", "compile") else "left", overflow="fold")
    for entry in row.entries:
        table.add_row(
            entry.name,
            duration(entry.seconds),
            duration(entry.compile_seconds),
            entry.note,
            style="bold" if entry.ours else "",
        )
    console.print(table)
    for line in _lines(row):
        console.print(line, highlight=False, markup=False)
    console.print()


def write(folder: Path, header: dict[str, str], rows: Sequence[Row]) -> None:
    """``results.json`` and ``results.md`` in ``folder``."""
    write_text(folder / "results.json", json_text({"header": header, "rows": [row.as_json() for row in rows]}))
    write_text(folder / "results.md", markdown(header, rows))


def markdown(header: dict[str, str], rows: Sequence[Row]) -> str:
    """The comparison as a Markdown page: targets first, then every row with its rivals."""
    lines = ["# Speed beside other tools", "", "| measurement | target | measured | |", "|---|---|---|---|"]
    for row in rows:
        lines += [f"| {row.title} | {asked(t)} | {_value(t)} | {t.verdict} |" for t in row.targets]
        if row.skipped:
            lines.append(f"| {row.title} | | | skipped |")
    for row in rows:
        lines += ["", f"## {row.title}", ""]
        if row.entries:
            lines += ["| who | time | compile | remarks |", "|---|---:|---:|---|"]
            lines += [_markdown_entry(entry) for entry in row.entries]
            lines.append("")
        lines += [f"- {line}" for line in _lines(row)]
        if row.curves:
            lines += ["", f"![{row.title}](growth.png)"]
    lines += ["", "## Measured with", "", "| | |", "|---|---|"]
    lines += [f"| {name} | {value} |" for name, value in header.items()]
    return "\n".join(lines) + "\n"


def duration(seconds: float | None) -> str:
    """A time in the unit that a reader would choose; a dash where there is none."""
    if seconds is None:
        return "–"
    for size, unit in ((3600.0, "h"), (60.0, "min"), (1.0, "s")):
        if seconds >= 2 * size or size == 1.0 <= seconds:
            return f"{seconds / size:.3g} {unit}"
    return f"{1000 * seconds:.3g} ms"


def asked(target: Target) -> str:
    sign = "≥" if target.relation == "at least" else "≤"
    return f"{target.text}: {sign} {target.limit:g}{target.unit}"


def _value(target: Target) -> str:
    if target.measured is None:
        return "–"
    number = f"{target.measured:.0f}" if abs(target.measured) >= 1000 else f"{target.measured:.3g}"
    return number + target.unit


def _lines(row: Row) -> list[str]:
    if row.skipped:
        return [f"skipped: {row.skipped}"]
    lines = [f"target {asked(t)}; measured {_value(t)}: {t.verdict}" for t in row.targets]
    lines += [f"agreement: {row.agreement}"] if row.agreement else []
    return lines + list(row.notes)


def _markdown_entry(entry: Entry) -> str:
    name = f"**{entry.name}**" if entry.ours else entry.name
    return f"| {name} | {duration(entry.seconds)} | {duration(entry.compile_seconds)} | {entry.note} |"
