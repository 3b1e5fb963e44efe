"""`greybox diagnose` on one data set of a fleet, on a worker: results written, and what came of it as a row."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import torch

from greybox_torch.api.arguments import named_model
from greybox_torch.api.diagnose import diagnose
from greybox_torch.api.diagnosis_result import DiagnosisResult, FoundParameter
from greybox_torch.data import load_dataset
from greybox_torch.diagnosis.settings import settings_from_mapping
from greybox_torch.fleets.isolation import own_registrations
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.store import store
from greybox_torch.fleets.verdict_row import row_of_verdict


def diagnosed(job: Job, row: Row, began: float) -> Row:
    """``row``, which says what was recorded, with the verdict; its seconds count since ``began`` (:func:`time.perf_counter`).

    Raises:
        UserError: something that the user has given is at fault, or the results cannot be written.
        NumericalError: the numbers fail.
    """
    choices = job.choices
    data = load_dataset(job.card)
    settings = settings_from_mapping(data.diagnosis, data.place("[diagnosis]"))
    settings = settings_from_mapping(choices.settings, choices.settings_from, settings)
    torch.manual_seed(choices.seed)
    with own_registrations():
        found = diagnose(
            named_model(job.card, data, choices.model),
            data,
            seed=choices.seed,
            device=choices.device,
            time_limit=choices.time_limit,
            settings=settings[0],
            budget=settings[1],
        )
        files = found.files(job.folder)
    told = row_of_verdict(found.verdict, _estimated(found), row)
    told = replace(told, fingerprint=row.fingerprint, seconds=round(time.perf_counter() - began, 3))
    store(job, told, files)
    return told


def _estimated(found: DiagnosisResult) -> dict[str, dict[str, float | str | None]]:
    return {name: _entry(p) for name, p in found.parameters.items() if not p.fixed}


def _entry(found: FoundParameter) -> dict[str, float | str | None]:
    """With no standard deviation where that is infinite: charts and tables have no place for it."""
    known = found.std is not None and math.isfinite(found.std)
    return {"value": found.value, "std": found.std if known else None, "unit": found.unit}
