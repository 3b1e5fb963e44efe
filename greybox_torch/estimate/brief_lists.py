"""Long lists of names and findings, said shortly: what is alike stands together, and of many the first are named."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.name_lists import brief, listed

MOST_SENTENCES = 5
"""Findings that are told in words; all are in the result's JSON."""

_DEVIATION = re.compile(r"standard deviation is about (\S+) times its value; (.*)")


def brief_sentences(found: Sequence[Unidentifiable]) -> list[str]:
    """Findings of single parameters that are alike in one sentence, and so are those that say the same of lists with names in common;
    each other one in its own, at most MOST_SENTENCES.
    """
    groups: dict[str, list[Unidentifiable]] = {}
    for one in _joined(found):
        groups.setdefault(_alike(one), []).append(one)
    told = [_told(group) for group in groups.values()]
    left = told[MOST_SENTENCES:]
    more = [f"and {len(left)} more findings of this kind, all of them in the JSON of the result"] if left else []
    return told[:MOST_SENTENCES] + more


def brief_pairs(pairs: Iterable[tuple[str, str, float]]) -> str:
    """Pairs of correlated names as groups that hang together: "a and b -0.998; c, d and e (0.951 and more)"."""
    groups: list[tuple[list[str], list[float]]] = []
    for one, other, value in pairs:
        touched = [group for group in groups if one in group[0] or other in group[0]]
        names = list(dict.fromkeys([*(n for group in touched for n in group[0]), one, other]))
        values = [*(v for group in touched for v in group[1]), value]
        groups = [group for group in groups if group not in touched] + [(names, values)]
    return "; ".join(
        f"{listed(names)} {values[0]:+.3f}"
        if len(names) == 2
        else f"{brief(names)} (at least {min(map(abs, values)):.3f})"
        for names, values in groups
    )


def _joined(found: Sequence[Unidentifiable]) -> list[Unidentifiable]:
    """Findings of several parameters that say the same and have some of these in common, as one of all of them."""
    result: list[Unidentifiable] = []
    for one in found:
        name, _, rest = one.sentence.partition(": ")
        if len(one.parameters) > 1 and name == brief(one.parameters):
            for other in [o for o in result if _says(o, rest) and set(o.parameters) & set(one.parameters)]:
                result.remove(other)
                names = tuple(dict.fromkeys([*other.parameters, *one.parameters]))
                one = replace(one, parameters=names, direction=(), sentence=f"{brief(names)}: {rest}")
        result.append(one)
    return result


def _says(one: Unidentifiable, rest: str) -> bool:
    return len(one.parameters) > 1 and one.sentence == f"{brief(one.parameters)}: {rest}"


def _alike(one: Unidentifiable) -> str:
    """What findings that belong together have in common."""
    name, _, rest = one.sentence.partition(": ")
    if len(one.parameters) != 1 or name != one.parameters[0]:
        return one.sentence
    return "weak" if one.kind == "weak" and _DEVIATION.search(rest) else rest


def _told(group: Sequence[Unidentifiable]) -> str:
    if len(group) == 1:
        return group[0].sentence
    names, rest = [one.parameters[0] for one in group], group[0].sentence.partition(": ")[2]
    weak = [_DEVIATION.search(one.sentence) for one in group]
    if all(weak):
        sizes = ", ".join(f"{name} {found[1]}" for name, found in zip(names, weak, strict=True) if found)
        what = f"weakly determined, with standard deviations of so many times their values: {sizes}"
        return f"{what}; fix them, or record experiments in which they act more"
    return f"{brief(names)}: of each, {rest}"
