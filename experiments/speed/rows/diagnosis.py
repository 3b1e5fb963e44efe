"""Row 9: whole diagnoses, by stage and by what their passes are for; beside another commit where one is named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from typing import Any

from experiments.speed.diagnosis.cases import ARM, PENDULUM, cases, development_cases
from experiments.speed.diagnosis.timed import LIMIT, Timed, checked_out, timed
from experiments.speed.row import Entry, Row, Target
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import CHECKOUT, Settings

TITLE = "Diagnoses from the shell, machine code cached"
NEEDS = Needs()
LEADS = 10.0
"""Seconds after which the leading finding should stand on the screen."""


def measure(settings: Settings, progress: Progress) -> Row:
    entries, details, changed = [], {}, []
    limit = 3.0 if settings.quick else None
    chosen = dict(list(cases().items())[:1]) if settings.quick else _asked(settings.cases)
    with ExitStack() as stack:
        other = stack.enter_context(checked_out(settings.against)) if settings.against else None
        for name, card in chosen.items():
            progress(name)
            ours = timed(CHECKOUT, card, limit)
            theirs = None if other is None else timed(other, card, limit)
            entries.append(_entry(name, ours))
            if other is not None:
                entries.append(_entry(f"{name}, at {settings.against}", theirs, ours))
            details[name] = [None if one is None else one.as_json() for one in (ours, theirs)]
            if ours is not None and theirs is not None and ours.said != theirs.said:
                changed.append(f"{name}: {theirs.said} -> {ours.said}")
    seconds = {n: d[0]["seconds"] for n, d in details.items() if d[0] is not None}
    return Row(
        "diagnosis",
        TITLE,
        entries=tuple(entries),
        targets=() if settings.quick else (*_targets(seconds, list(chosen)), _leading(details)),
        agreement=("; ".join(changed) or "both commits say the same on every case") if settings.against else "",
        notes=(
            "compile: what the same takes longer with an empty cache; passes in seconds of the thread that asks for them",
        ),
        details=details,
    )


def _asked(names: Sequence[str]) -> dict[str, Path]:
    """The cases of these names, all where there is none.

    Raises:
        ValueError: there is no such case.
    """
    every = cases()
    unknown = [name for name in names if name not in every]
    if unknown:
        raise ValueError(f"--cases: no case is called {'; '.join(unknown)}; expected some of {'; '.join(every)}")
    return {name: card for name, card in every.items() if not names or name in names}


def _entry(name: str, found: Timed | None, beside: Timed | None = None) -> Entry:
    ours = not name.partition(", at ")[1]
    if found is None:
        return Entry(name, None, ours=ours, note=f"not ended within {LIMIT} s, or failed")
    ratio = "" if beside is None else f"{found.seconds / beside.seconds:.2f} times as long; "
    note = f"{ratio}{found.said} (leads from {found.leading:.1f} s on); {found.largest}"
    return Entry(name, found.seconds, found.cold - found.seconds, ours, note)


def _leading(details: Mapping[str, Sequence[Mapping[str, Any] | None]]) -> Target:
    """Of all cases the share whose leading finding stands on the screen in time."""
    after = [float("inf") if d[0] is None else d[0]["leading"] for d in details.values()]
    share = 100.0 * sum(seconds <= LEADS for seconds in after) / max(len(after), 1)
    return Target(f"cases whose leading finding stands after {LEADS:g} s", "at least", 90.0, share, " %")


def _targets(seconds: dict[str, float], names: list[str]) -> tuple[Target, ...]:
    """What is asked of the development cases and of two recordings, where they are there."""
    development = development_cases(names)
    own = [seconds.get(name, float("inf")) for name in development]
    found = [
        Target("development cases, median", "at most", 10.0, median(own) if own else None, " s"),
        Target("development cases, slowest", "at most", 30.0, max(own) if own else None, " s"),
    ]
    for name, most in ((ARM, 30.0), (PENDULUM, 60.0)):
        if name in names:
            found.append(Target(name, "at most", most, seconds.get(name, float("inf")), " s"))
    return tuple(found)
