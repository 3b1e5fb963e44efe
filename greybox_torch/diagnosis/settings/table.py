"""The settings of a diagnosis as rows of a table, those that differ from their default first."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from greybox_torch.diagnosis.settings.budget import SearchBudget
from greybox_torch.diagnosis.settings.fields import about
from greybox_torch.diagnosis.settings.thresholds import DiagnosisSettings
from greybox_torch.estimate.levenberg_marquardt import Settings


@dataclass(frozen=True)
class SettingRow:
    """One field: its value and default in words, whether they differ, its unit, what it means and what the default was chosen by."""

    name: str
    value: str
    default: str
    changed: bool
    unit: str
    meaning: str
    chosen_by: str


def setting_rows(settings: DiagnosisSettings, budget: SearchBudget) -> tuple[SettingRow, ...]:
    """Every field of both, those that differ from their default first."""
    rows = []
    for owner in (settings, budget):
        for field in dataclasses.fields(owner):
            value, what = getattr(owner, field.name), about(field)
            changed = value != field.default
            rows.append(
                SettingRow(
                    field.name, _text(value), _text(field.default), changed, what.unit, what.meaning, what.chosen_by
                )
            )
    return tuple(sorted(rows, key=lambda row: not row.changed))


def _text(value: Any) -> str:
    if isinstance(value, Settings):
        return f"{value.iterations}, {value.tolerance:g}, {value.trials}"
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    return f"{value:g}"
