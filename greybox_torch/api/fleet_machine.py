"""What a worker does with one data set of a fleet. Whether anything is to be done at all is found out before torch is loaded."""

from __future__ import annotations

import time
import traceback
from dataclasses import replace

from greybox_torch.data import load_dataset
from greybox_torch.data.card import Card, read_card
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.fleets.fingerprint import fingerprint
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.store import ROW, store_failure, stored


def diagnose_machine(job: Job) -> tuple[Row, bool]:
    """The row of one data set, and whether it is that of an earlier run, as nothing has changed since.

    Whatever goes wrong with the data set is a row as well; only what ends the process is not.
    """
    began = time.perf_counter()
    row = _empty(job)
    try:
        card = read_card(job.card)
        row = row.described(card)
        row = replace(row, fingerprint=_fingerprint(job, card))
        done = stored(job, row.fingerprint)
        if done is not None:
            return done, True
        from greybox_torch.api.fleet_diagnosis import diagnosed

        return diagnosed(job, row, began), False
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # sys.exit in a reader of the user's is one too
        kind, message = _why(error)
        row = replace(row, failure=kind, message=message, seconds=time.perf_counter() - began)
        return _failed(job, row), False


def without_a_diagnosis(job: Job) -> tuple[Row, bool] | None:
    """The same where there is nothing to be diagnosed: the card is at fault, or nothing has changed since an earlier run; else None."""
    began, row = time.perf_counter(), _empty(job)
    try:
        card = read_card(job.card)
        row = row.described(card)
        done = stored(job, _fingerprint(job, card)) if (job.folder / ROW).is_file() else None
        return None if done is None else (done, True)
    except UserError as error:
        return _failed(
            job, replace(row, failure="input", message=str(error), seconds=time.perf_counter() - began)
        ), False
    except Exception:  # of another kind: the worker that has it says what
        return None


def _fingerprint(job: Job, card: Card) -> str:
    """The fingerprint; of a recording that cannot be read, reading the data set says more: card, experiment, and the near name."""
    try:
        return fingerprint(job, card)
    except UserError:
        load_dataset(job.card)
        raise


def _empty(job: Job) -> Row:
    return Row(job.name, str(job.card), "failed", machine=job.name)


def _why(error: BaseException) -> tuple[str, str]:
    """The kind of a failure, and what to say of it."""
    match error:
        case UserError():
            return "input", str(error)
        case NumericalError():
            return "numbers", str(error)
        case MemoryError():
            return "memory", "needs more memory than there is"
        case _:
            last = traceback.extract_tb(error.__traceback__)[-1]
            return "error", f"{type(error).__name__}: {error} ({last.filename}, line {last.lineno})"


def _failed(job: Job, row: Row) -> Row:
    """The row, written; it says so where even that fails."""
    try:
        store_failure(job, row)
    except UserError as error:
        return replace(row, message=f"{row.message}; {error}")
    return row
