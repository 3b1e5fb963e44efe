"""Progress on standard error: one line that changes on a terminal, plain lines elsewhere."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.text import Text

from greybox_torch.commands.time_left import TimeLeft, told_left

if TYPE_CHECKING:
    from greybox_torch.diagnosis.progress import Progress as Standing


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


@contextmanager
def diagnosing(first: str) -> Iterator[Callable[[Standing], None]]:
    """A function that is told where a diagnosis stands.

    On a terminal one line that changes, with the leading finding beside what is being done; elsewhere a line whenever that finding changes.
    """
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield _findings(console, first)
        return
    columns = (
        SpinnerColumn(),
        TimeElapsedColumn(),
        TextColumn("[bold]{task.fields[leading]}"),
        TextColumn("[dim]{task.description}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(escape(first), leading="")
        yield lambda now: bar.update(task, description=escape(now.doing or first), leading=escape(now.leading))


def _findings(console: Console, first: str) -> Callable[[Standing], None]:
    """A line for every leading finding."""
    console.print(f"{0.0:7.1f} s  {escape(first)}", soft_wrap=True)
    told, lock = "", threading.Lock()

    def tell(now: Standing) -> None:
        nonlocal told
        with lock:
            if now.leading != told:
                told = now.leading
                console.print(f"{now.seconds:7.1f} s  {escape(told or 'nothing so far')}", soft_wrap=True)

    return tell


_ITERATION = re.compile(r", iteration \d+:")

LINE_SECONDS = 5.0
"""Time between two lines on the course of a computation that say nothing else new, or until the second of them."""


def news(write: Callable[[str], None]) -> Callable[[str], None]:
    """Passes lines on to ``write``, but of the iterations of one stage a few alone: the first, one after five seconds, one after ten
    more, one after twenty more, and so on; and the last. At the end it has to be told "".
    """
    stage, due, wait, held = "", 0.0, LINE_SECONDS, ""

    def tell(line: str) -> None:
        nonlocal stage, due, wait, held
        now = time.perf_counter()
        at = _ITERATION.search(line)
        new = at is None or line[: at.start()] != stage
        if not new and now < due:
            held = line
            return
        if new and held:
            write(held)
        if not line:
            held = ""
            return
        stage, wait, held = line[: at.start()] if at else "", LINE_SECONDS if new else 2.0 * wait, ""
        due = now + wait
        write(line)

    return tell


@contextmanager
def estimating() -> Iterator[Callable[[str], None]]:
    """A function that is told the course of an estimation.

    On a terminal its iterations are one line that changes and vanishes at the end; whatever else is said stays. Elsewhere see :func:`news`.
    """
    console = Console(stderr=True, highlight=False)
    write: Callable[[str], None] = lambda line: console.print(Text(line), soft_wrap=True)  # noqa: E731
    if not console.is_terminal:
        tell = news(write)
        yield tell
        tell("")
        return
    columns = SpinnerColumn(), TimeElapsedColumn(), TextColumn("{task.description}")
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("estimating")
        yield lambda line: bar.update(task, description=escape(line)) if _ITERATION.search(line) else write(line)


@contextmanager
def training(first: str) -> Iterator[Callable[[str, float, str], None]]:
    """A function that is told the stage, the share of the epochs done, and the last figures; the bar says how much time is left."""
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield _lines(console, first)
        return
    columns = (
        SpinnerColumn(),
        TimeElapsedColumn(),
        BarColumn(24),
        TextColumn("{task.description}"),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task, rate = bar.add_task(escape(first), total=1.0, left=""), TimeLeft()
        yield lambda stage, share, line: bar.update(
            task,
            completed=share,
            description=escape(f"{stage}  {line}" if line else stage),
            left=told_left(rate.after(time.perf_counter(), share)),
        )


def _lines(console: Console, first: str) -> Callable[[str, float, str], None]:
    """A line at every new stage, and every few seconds within one, with the time left."""
    began = time.perf_counter()
    before, due, rate = "", 0.0, TimeLeft()

    def tell(stage: str, share: float, line: str) -> None:
        nonlocal before, due
        now = time.perf_counter() - began
        left = told_left(rate.after(now, share))
        if stage == before and now < due:
            return
        before, due = stage, now + LINE_SECONDS
        said = "  ".join(part for part in (stage, line, left) if part)
        console.print(f"{now:7.1f} s  {escape(said)}", soft_wrap=True)

    tell(first, 0.0, "")
    return tell
