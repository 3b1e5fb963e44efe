"""One data set must not change the diagnosis of the next one in the same process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from greybox_torch.data.readers import READERS
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.report.sections.order import SECTIONS, TEMPLATES


@contextmanager
def own_registrations() -> Iterator[None]:
    """Mechanisms, readers and sections of the report that a model's file registers take part within the block, and are gone after it."""
    tables: list[dict[str, Any]] = [LIBRARY, READERS, SECTIONS, TEMPLATES]
    before = [dict(table) for table in tables]
    try:
        yield
    finally:
        for table, was in zip(tables, before, strict=True):
            table.clear()
            table.update(was)
