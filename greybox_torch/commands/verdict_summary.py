"""What `greybox diagnose` prints."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.console import Console
from rich.text import Text

from greybox_torch.commands.free_runs import print_scores
from greybox_torch.commands.tables import print_table
from greybox_torch.commands.task import Task
from greybox_torch.diagnosis.verdict import Effect, Verdict

UNKNOWN = "unknown"
_COLUMNS = ["port", "mechanism", "probability", "explains [%]", "parameter", "value", "std", "unit"]


def print_verdict(console: Console, task: Task, verdict: Verdict) -> None:
    """The verdict in one sentence, the effects with their parameters, fit and error before and after, and where the results are."""
    console.print(Text(f"{task.data.name}: {task.model.title}", style="bold"))
    console.print(Text(f"\n{verdict.sentence}", style="bold"), soft_wrap=True)
    if verdict.effects:
        print_table(console, _COLUMNS, [row for effect in verdict.effects for row in _rows(effect)])
        for effect in verdict.effects:
            _print_notes(console, effect)
    else:
        for sentence in verdict.evidence:
            console.print(Text(f"- {sentence}"), soft_wrap=True)
    console.print()
    models = ("start", "refit", "augmented") if verdict.effects else ("start", "refit")
    print_scores(console, task.data, {name: verdict.scores[name] for name in models})
    console.print(Text(f"{verdict.seconds:.1f} s, seed {verdict.seed}"))
    files = "report.html, verdict.json, model.safetensors, model.json"
    console.print(Text(f"Written to {task.folder}: {files}"), soft_wrap=True)


def _rows(effect: Effect) -> Iterator[list[str | float]]:
    """A line for every parameter of a law; one for a curve, whose heights mean little one by one."""
    first: list[str | float] = [effect.port, effect.mechanism, effect.probability, 100.0 * effect.explained]
    if effect.mechanism == UNKNOWN or not effect.parameters:
        yield [*first, f"curve over {', '.join(effect.signals)}", "", "", ""]
        return
    for name, entry in effect.parameters.items():
        yield [*first, name, float(entry["value"]), _deviation(entry.get("std")), entry.get("unit", "")]
        first = [""] * len(first)


def _deviation(value: float | None) -> str | float:
    if value is None:
        return ""
    return value if math.isfinite(value) else "undetermined"


def _print_notes(console: Console, effect: Effect) -> None:
    head = f"{effect.mechanism} at {effect.port}"
    lines = [f"{head}: {effect.where}"] if effect.where else []
    if effect.alternatives:
        rivals = ", ".join(f"{a.mechanism} at {a.port} ({a.probability:.2f})" for a in effect.alternatives)
        advice = f"; to tell them apart: {effect.separating_experiment}" if effect.separating_experiment else ""
        lines.append(f"{head}: it could also be {rivals}{advice}")
    for line in lines:
        console.print(Text(line), soft_wrap=True)
