"""The row of a data set that ended the processes of its workers."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

from greybox_torch.data.card import read_card
from greybox_torch.errors import UserError
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.store import store_failure

WHY = (
    "the worker processes that had it ended, also when it was the only one under way: they crashed, were killed, or ran out of memory; "
    "greybox diagnose on its card alone shows more"
)


def killed_row(job: Job) -> Row:
    """The row, written to the folder of its results."""
    row = Row(job.name, str(job.card), "failed", machine=job.name, failure="killed", message=WHY)
    with suppress(UserError):  # the card is what is wrong, perhaps
        row = row.described(read_card(job.card))
    try:
        store_failure(job, row)
    except UserError as error:
        return replace(row, message=f"{row.message} ({error})")
    return row
