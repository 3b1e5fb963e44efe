"""How far a fleet has come, on standard error: a bar on a terminal, a line every few seconds elsewhere."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from greybox_torch.commands.progress import LINE_SECONDS
from greybox_torch.fleets.progress import Progress as Reached
from greybox_torch.fleets.progress import Tell
from greybox_torch.report import text


@contextmanager
def counting(first: str) -> Iterator[Tell]:
    """A function that is told how far it has come. The bar vanishes at the end."""
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield _lines(console, first)
        return
    columns = (SpinnerColumn(), TimeElapsedColumn(), BarColumn(24), TextColumn("{task.description}"))
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(escape(first), total=None)
        yield lambda reached: bar.update(
            task, total=reached.total, completed=reached.done, description=escape(in_words(reached))
        )


def in_words(reached: Reached) -> str:
    """Such as `12 of 64 done (1 failed, 3 unchanged), 0.31 a second, about 2 min 48 s left`."""
    notes = [f"{n} {what}" for n, what in ((reached.failed, "failed"), (reached.kept, "unchanged")) if n]
    parts = [f"{reached.done} of {reached.total} done" + (f" ({', '.join(notes)})" if notes else "")]
    if reached.rate > 0.0:
        parts.append(f"{text.number(reached.rate, 2)} a second")
    if reached.seconds_left:
        parts.append(f"about {text.seconds(reached.seconds_left)} left")
    return ", ".join(parts)


def _lines(console: Console, first: str) -> Tell:
    """A line for the first and the last, and every few seconds between."""
    due = 0.0

    def tell(reached: Reached) -> None:
        nonlocal due
        now = time.perf_counter()
        if now < due and reached.done < reached.total:
            return
        due = now + LINE_SECONDS
        last = f"  {reached.last.dataset}" if reached.last else ""
        console.print(f"{reached.seconds:7.1f} s  {escape(in_words(reached))}{escape(last)}", soft_wrap=True)

    console.print(escape(first), soft_wrap=True)
    return tell
