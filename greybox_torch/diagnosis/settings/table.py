"""The settings of a diagnosis as rows of a table, and those that differ from their default in JSON."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
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
    for field, value in _fields(settings, budget):
        what, changed = about(field), value != field.default
        told = (_text(value), _text(field.default), changed, what.unit, what.meaning, what.chosen_by)
        rows.append(SettingRow(field.name, *told))
    return tuple(sorted(rows, key=lambda row: not row.changed))


def changed_settings(settings: DiagnosisSettings, budget: SearchBudget) -> dict[str, Any]:
    """By name, the values that differ from their default, as :func:`settings_from_mapping` takes them: the same run once more."""
    return {field.name: _plain(value) for field, value in _fields(settings, budget) if value != field.default}


def _fields(settings: DiagnosisSettings, budget: SearchBudget) -> Iterator[tuple[dataclasses.Field[Any], Any]]:
    for owner in (settings, budget):
        for field in dataclasses.fields(owner):
            yield field, getattr(owner, field.name)


def _plain(value: Any) -> Any:
    """As JSON and TOML have it."""
    if isinstance(value, Settings):
        return dataclasses.asdict(value)
    return list(value) if isinstance(value, tuple) else value


def _text(value: Any) -> str:
    if isinstance(value, Settings):
        return f"{value.iterations}, {value.tolerance:g}, {value.trials}, {value.damping:g}"
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    return f"{value:g}"
