"""The folder of one data set's results: what `greybox diagnose` writes there, and beside it the row of the fleet's table.

The row is written together with the other files and takes its place last. So a data set counts as done exactly when its row is there,
whoever was killed meanwhile: a worker, the scheduler or the command itself.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

from greybox_torch.errors import UserError
from greybox_torch.files import json_text, remove_all, write_all, write_text
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.row import Row
from greybox_torch.reading import read_json
from greybox_torch.result_names import OF_A_DIAGNOSIS, RIVALS

ROW = "fleet_row.json"


def stored(job: Job, fingerprint: str) -> Row | None:
    """The row of an earlier run, if it came to a verdict on the same files with the same choices, and its files are all there."""
    try:
        row = Row.from_json(read_json(job.folder / ROW, "a row of the fleet's table"))
    except (UserError, ValueError):
        return None
    whole = all((job.folder / name).is_file() for name in OF_A_DIAGNOSIS)
    return row if whole and not row.failed and row.fingerprint == fingerprint else None


def store(job: Job, row: Row, files: Mapping[Path, str | bytes]) -> None:
    """Write the results of a diagnosis with their row. Raises UserError where one cannot be written, and then writes none.

    Rivals of an earlier run that are none any more are removed.
    """
    write_all({**files, job.folder / ROW: json_text(row.as_json())})
    remove_all(path for path in (job.folder / RIVALS).glob("*") if path not in files)


def store_failure(job: Job, row: Row) -> None:
    """Write the row of a data set without a verdict, and remove the results that an earlier run had for it.

    Raises UserError where it cannot be written.
    """
    remove_all(job.folder / name for name in OF_A_DIAGNOSIS)
    shutil.rmtree(job.folder / RIVALS, ignore_errors=True)
    write_text(job.folder / ROW, json_text(row.as_json()))
