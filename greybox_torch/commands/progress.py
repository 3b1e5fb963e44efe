"""Progress on standard error: one line that changes on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn


@contextmanager
def stages(first: str) -> Iterator[Callable[[str], None]]:
    """A function that says what is being done now, beside the time since the beginning. The line vanishes at the end."""
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        began = time.perf_counter()

        def line(what: str) -> None:
            console.print(f"{time.perf_counter() - began:7.1f} s  {escape(what)}", soft_wrap=True)

        line(first)
        yield line
        return
    with Progress(
        SpinnerColumn(), TimeElapsedColumn(), TextColumn("{task.description}"), console=console, transient=True
    ) as bar:
        task = bar.add_task(escape(first))
        yield lambda what: bar.update(task, description=escape(what))
