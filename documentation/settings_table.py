"""The page of the settings of a diagnosis: each with its default, its unit, what it means and what it was chosen by."""

from __future__ import annotations

from documentation.tables import table
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.settings.table import setting_rows


def page() -> str:
    """The page in Markdown."""
    thresholds = {field for base in DiagnosisSettings.__mro__ for field in vars(base).get("__annotations__", {})}
    rows = setting_rows(DiagnosisSettings(), SearchBudget())
    lines = [
        "# Settings of a diagnosis",
        "",
        "By name in the card's table `[diagnosis]` (`least_gain = 0.02`), or in a file of their own, "
        "`greybox diagnose --settings FILE.toml`, which goes before the card; "
        "from Python `gt.DiagnosisSettings(least_gain=0.02)` and `gt.SearchBudget(most_effects=2)`.",
    ]
    for title, chosen in (
        ("Thresholds", [row for row in rows if row.name in thresholds]),
        ("Budget of the search", [row for row in rows if row.name not in thresholds]),
    ):
        cells = ((f"`{row.name}`", row.default, row.unit, row.meaning, row.chosen_by) for row in chosen)
        lines += ["", f"## {title}", "", *table(("name", "default", "unit", "meaning", "chosen by"), cells)]
    return "\n".join(lines) + "\n"
