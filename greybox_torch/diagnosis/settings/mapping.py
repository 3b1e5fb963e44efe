"""Settings from a card's table ``[diagnosis]`` or from a file of their own."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from greybox_torch.diagnosis.settings.budget import SearchBudget
from greybox_torch.diagnosis.settings.fields import about, complaint
from greybox_torch.diagnosis.settings.thresholds import DiagnosisSettings
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.reading import read_toml

Both = tuple[DiagnosisSettings, SearchBudget]
DEFAULTS: Both = (DiagnosisSettings(), SearchBudget())


def settings_from_mapping(mapping: Mapping[str, Any], where: str, base: Both = DEFAULTS) -> Both:
    """Settings and budget with the fields that ``mapping`` names; the others as ``base`` has them, by default the defaults.

    Lists stand for several integers, tables (``{ iterations = 20, tolerance = 1e-4 }``) for the limits of an iteration.

    Args:
        where: what a message begins with, such as ``dataset.toml: [diagnosis]``.

    Raises:
        UserError: a name is unknown, or a value is out of its bounds; the message names the field, what was found and what is expected.
    """
    owner = {f.name: (kind, f) for kind in base for f in dataclasses.fields(kind)}
    given: dict[str, Any] = {}
    for name, value in mapping.items():
        if name not in owner:
            raise UserError(
                f'{where}: "{name}" is not a setting{did_you_mean(name, owner)}; expected a field of DiagnosisSettings or SearchBudget'
            )
        kind, field = owner[name]
        value = _as_field(value, getattr(kind, name), f"{where}: {name}")
        wrong = complaint(about(field), value)
        if wrong:
            raise UserError(f"{where}: {name}: {wrong}")
        given[name] = value
    settings, budget = (
        dataclasses.replace(kind, **{n: v for n, v in given.items() if owner[n][0] is kind}) for kind in base
    )
    assert isinstance(settings, DiagnosisSettings) and isinstance(budget, SearchBudget)
    return settings, budget


def settings_from_file(path: Path) -> dict[str, Any]:
    """What a TOML file of settings names, for :func:`settings_from_mapping`; a table ``[diagnosis]`` in it may hold them all.

    Raises:
        UserError: the file cannot be read, or is not TOML.
    """
    content = read_toml(path, "settings of a diagnosis, in TOML")
    inner = content.get("diagnosis")
    return inner if isinstance(inner, dict) and len(content) == 1 else content


def _as_field(value: Any, default: Any, where: str) -> Any:
    if isinstance(default, tuple) and isinstance(value, list):
        return tuple(value)
    if isinstance(default, Settings) and isinstance(value, Mapping):
        known = [f.name for f in dataclasses.fields(Settings)]
        unknown = next((n for n in value if n not in known), None)
        if unknown is not None:
            raise UserError(
                f'{where}: "{unknown}" is unknown{did_you_mean(unknown, known)}; expected {", ".join(known)}'
            )
        return dataclasses.replace(default, **value)
    return value
