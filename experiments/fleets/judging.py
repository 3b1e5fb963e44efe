"""What a fleet's result is worth, given what was drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from experiments.fleets.plan import KINDS, Planned

NEAR = 1
"""Recordings by which the date of a change may be off."""
OF_THE_CLOCK = ("seconds", "stages")
"""What a verdict says of time, which differs from run to run."""


def judged(planned: Sequence[Planned], result: Mapping[str, Any]) -> dict[str, Any]:
    """Counts of right names and dates.

    ``named`` of ``with_effect`` recordings carry an accepted name, ``quiet`` of ``without`` find nothing; ``dated`` of ``changed`` machines
    have a change within one recording of the true one; ``false_changes`` of all ``machines`` have one elsewhere. ``wrong`` lists what was
    not so.
    """
    rows = {(row["machine"], row["recorded"]): row for row in result["machines"]}
    found: dict[str, Any] = {"machines": len(planned), "data_sets": len(rows), "with_effect": 0, "named": 0}
    found |= {"without": 0, "quiet": 0, "changed": 0, "dated": 0, "false_changes": 0}
    wrong: list[str] = []
    for machine in planned:
        for date, size in zip(machine.dates, machine.sizes, strict=True):
            row = rows[machine.name, date]
            if size > 0.0:
                found["with_effect"] += 1
                right = (row["port"], row["mechanism"]) in KINDS[machine.effect].accept
                found["named"] += right
            else:
                found["without"] += 1
                right = row["answer"] == "nothing"
                found["quiet"] += right
            if not right:
                told = f"{row['mechanism']} at {row['port']}" if row["mechanism"] else row["answer"]
                wrong.append(f"{machine.name} {date}: {machine.effect or 'nothing'} of size {size:g}, said {told}")
        _judge_changes(machine, result["changes"], found, wrong)
    return {**found, "wrong": wrong}


def _judge_changes(
    machine: Planned, changes: Sequence[Mapping[str, Any]], found: dict[str, Any], wrong: list[str]
) -> None:
    own = [change for change in changes if change["machine"] == machine.name]
    places = [machine.dates.index(change["date"]) for change in own]
    near = [machine.changed is not None and abs(place - machine.changed) <= NEAR for place in places]
    found["false_changes"] += not all(near)
    if machine.changed is not None:
        found["changed"] += 1
        found["dated"] += any(near)
        if not any(near):
            wrong.append(f"{machine.name}: its change before {machine.dates[machine.changed]} was not dated")
    for change, right in zip(own, near, strict=True):
        if not right:
            wrong.append(f"{machine.name}: {change['what']} said to change before {change['date']}")


def same_verdict(first: Mapping[str, Any], second: Mapping[str, Any]) -> bool:
    """Whether two verdicts differ in nothing but time."""
    return _timeless(first) == _timeless(second)


def _timeless(verdict: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in verdict.items() if name not in OF_THE_CLOCK}
