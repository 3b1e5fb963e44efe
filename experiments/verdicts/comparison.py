"""Two folders of verdicts on the same cases: equal to the last digit, or what changed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.verdicts.running import VERDICT
from greybox_torch import UserError
from greybox_torch.errors import did_you_mean

OF_THE_RUN = ("seconds", "stages")
"""Fields that differ from run to run of the same tool."""
APART = ("mismatch", "effects", "fit")
"""Fields whose changes are told in words of their own."""


@dataclass(frozen=True)
class Change:
    """One case in both folders: what changed, in sentences; empty where nothing did."""

    name: str
    changes: tuple[str, ...]


def compare_all(before: Path, after: Path, only: Sequence[str] = ()) -> list[Change]:
    """Every case that has a verdict in either folder, sorted by name, or those of `only`.

    Raises UserError where a folder holds none, or neither one of that name.
    """
    found = {folder: {file.parent.name: file for file in folder.glob(f"*/{VERDICT}")} for folder in (before, after)}
    for folder, files in found.items():
        if not files:
            raise UserError(f"{folder}: no verdict is in it; expected NAME/{VERDICT}, as `run` writes them")
    known = {*found[before], *found[after]}
    for name in only:
        if name not in known:
            raise UserError(f"--only: neither folder has a verdict on {name}{did_you_mean(name, known)}")
    return [_change(name, found[before].get(name), found[after].get(name)) for name in only or sorted(known)]


def compared(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[str]:
    """What changed from one verdict to the other, whatever belongs to the run alone left out."""
    changes = []
    if before["mismatch"] != after["mismatch"]:
        changes.append(f"mismatch: {_word(before['mismatch'])} -> {_word(after['mismatch'])}")
    changes += _effects(before["effects"], after["effects"])
    changes += _fits(before["fit"], after["fit"])
    fields = sorted({*before, *after} - {*OF_THE_RUN, *APART})
    rest = [path for field in fields for path in _differences(before.get(field), after.get(field), field)]
    if rest:
        changes.append(f"{len(rest)} other fields: {', '.join(rest[:4])}{', …' if len(rest) > 4 else ''}")
    return changes


def _change(name: str, before: Path | None, after: Path | None) -> Change:
    if before is None or after is None:
        return Change(name, (f"a verdict only {'after' if before is None else 'before'}",))
    first, second = (json.loads(file.read_text(encoding="utf-8")) for file in (before, after))
    return Change(name, tuple(compared(first, second)))


def _effects(before: Sequence[Mapping[str, Any]], after: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Names that came and went, their order, and the probabilities and figures of those that stayed."""
    old, new = ({f"{e['mechanism']} at {e['port']}": e for e in effects} for effects in (before, after))
    for name in old:
        if name not in new:
            yield f"gone: {name} ({old[name]['probability']:.2f})"
    for name in new:
        if name not in old:
            yield f"new: {name} ({new[name]['probability']:.2f})"
    if [name for name in old if name in new] != [name for name in new if name in old]:
        yield "the effects stand in another order"
    for name in old:
        if name in new:
            if old[name]["probability"] != new[name]["probability"]:
                yield f"{name}: probability {old[name]['probability']:.6g} -> {new[name]['probability']:.6g}"
            others = [path for path in _differences(old[name], new[name], "") if path != "probability"]
            if others:
                yield f"{name}: {', '.join(others[:4])}{', …' if len(others) > 4 else ''} changed"


def _fits(before: Sequence[Mapping[str, Any]], after: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """By stage, how many rows changed, and the row that changed most."""
    old, new = ({(r["experiment"], r["output"]): r for r in rows} for rows in (before, after))
    if list(old) != list(new) or [r["role"] for r in before] != [r["role"] for r in after]:
        yield f"fit: other rows ({len(before)} -> {len(after)}), or other roles"
        return
    for stage in ("start", "refit", "augmented"):
        changed = {k: (old[k].get(stage), new[k].get(stage)) for k in old if old[k].get(stage) != new[k].get(stage)}
        if changed:
            (experiment, output), (first, second) = max(changed.items(), key=lambda item: _distance(*item[1]))
            fits = [_number(scores["fit"] if scores else None) for scores in (first, second)]
            yield f"{stage}: {len(changed)} of {len(old)} fits, {output} in {experiment} from {fits[0]} to {fits[1]} %"


def _differences(first: Any, second: Any, path: str) -> Iterator[str]:
    """Paths at which two JSON values differ, to the last digit."""
    if isinstance(first, dict) and isinstance(second, dict):
        for key in sorted({*first, *second}):
            at = f"{path}.{key}" if path else key
            yield from _differences(first[key], second[key], at) if key in first and key in second else [at]
    elif isinstance(first, list) and isinstance(second, list) and len(first) == len(second):
        for i, (a, b) in enumerate(zip(first, second, strict=True)):
            yield from _differences(a, b, f"{path}[{i}]")
    elif first != second:
        yield path


def _distance(first: Mapping[str, Any] | None, second: Mapping[str, Any] | None) -> float:
    fits = [scores["fit"] if scores else None for scores in (first, second)]
    return float("inf") if None in fits else abs(fits[0] - fits[1])


def _number(fit: float | None) -> str:
    return "nothing" if fit is None else f"{fit:.6g}"


def _word(mismatch: bool) -> str:
    return "missing" if mismatch else "nothing missing"
