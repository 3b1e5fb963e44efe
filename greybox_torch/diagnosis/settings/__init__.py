"""What a diagnosis is decided by (:class:`DiagnosisSettings`) and how much it may compute (:class:`SearchBudget`)."""

from greybox_torch.diagnosis.settings.budget import SearchBudget
from greybox_torch.diagnosis.settings.mapping import settings_from_file, settings_from_mapping
from greybox_torch.diagnosis.settings.table import SettingRow, changed_settings, setting_rows
from greybox_torch.diagnosis.settings.thresholds import DiagnosisSettings

__all__ = [
    "DiagnosisSettings",
    "SearchBudget",
    "SettingRow",
    "changed_settings",
    "setting_rows",
    "settings_from_file",
    "settings_from_mapping",
]
