"""What was measured, as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import mean, median
from typing import Any


def page(measured: Mapping[str, Any]) -> str:
    """In Markdown."""
    about, choices, judged = measured["about"], measured["choices"], measured["judged"]
    done, alone = measured["interrupted"], measured["alone"]
    one, two = measured["throughput"]
    seconds = done["diagnosing_seconds"]
    told = [
        ("verdicts that differ from those one by one", f"{len(alone['different'])} of {alone['compared']} compared"),
        ("recordings with an effect: named rightly", _of(judged["named"], judged["with_effect"])),
        ("recordings without: nothing found", _of(judged["quiet"], judged["without"])),
        ("machines that changed: dated within one recording", _of(judged["dated"], judged["changed"])),
        ("machines with a false change", _of(judged["false_changes"], judged["machines"])),
        (
            "a worker killed after a quarter, the command after a half: rows missing",
            str(done["data_sets"] - done["rows"]),
        ),
        ("failed", str(len(done["failed"]))),
        ("done before the restart, and done again", f"{done['done_before_the_restart']}, {done['of_them_done_again']}"),
        ("data sets a second, one worker", f"{one['per_second']:.3f} (load {one['load']:.1f})"),
        (
            "two workers",
            f"{two['per_second']:.3f} (load {two['load']:.1f}): {two['per_second'] / one['per_second']:.2f} times",
        ),
        (
            "processor seconds for a data set, one worker, its start with it",
            f"{one['processor'] / one['data_sets']:.2f}",
        ),
        ("seconds of the clock for a data set: median, largest", f"{median(seconds):.2f}, {max(seconds):.2f}"),
        ("most memory of a worker, of the command", f"{done['worker_memory']:.0f}, {done['own_memory']:.0f} MiB"),
        ("`greybox diagnose` alone: processor seconds, mean", f"{mean(alone['processor']):.2f}"),
    ]
    growth = [
        [f"{g['samples']}", f"{g['processor']:.2f}", f"{g['seconds']:.2f}", f"{g['memory']:.0f}"]
        for g in measured["growth"]
    ]
    stages = [[name, f"{value:.3f}"] for name, value in done["stages"].items()]
    of = "" if choices["first"] is None else f"the first {choices['first']} of "
    drawn = f"{of}{choices['machines']} machines with {choices['recordings']} recordings of 2 × {choices['samples']} samples each"
    head = (
        f"Commit {about['commit']}, {about['date']}, {about['processor']}, {about['cores']} cores. {drawn}, "
        f"{choices['workers']} workers, seed {choices['seed']}."
    )
    parts = [
        head,
        _table(["measured", "found"], told),
        _table(["samples", "processor s", "s", "MiB"], growth),
        _table(["stage of a diagnosis", "s, mean"], stages),
    ]
    wrong = "\n".join(f"- {text}" for text in judged["wrong"])
    return "\n\n".join([*parts, *(["What was wrong:", wrong] if wrong else [])]) + "\n"


def _of(count: int, total: int) -> str:
    return f"{count} of {total}" + (f" ({100.0 * count / total:.1f} %)" if total else "")


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
