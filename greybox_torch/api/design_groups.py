"""What a designed recording is expected to say where it tells groups of hypotheses apart, and not those within one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.api.expected import Expected

AGAINST_GROUPS = (
    "Evidence is that for a hypothesis, if it is right, against the nearest one of another group, and of its own group: two of which one "
    "would have little against the other count as one."
)
"""What the columns of the table say."""

NUMBERS = ("no", "one", "two", "three", "four", "five", "six")


def told_of_groups(names: Sequence[str], expected: Expected, recording: str, what: str) -> str:
    """In a sentence or two: which groups are told apart, whether that says more than is known, and that no ``what`` tells those within one
    apart. ``recording``: what it is, and how long.
    """
    asked = [[names[k] for k in group if k in expected.in_question] for group in expected.groups]
    groups = [" or ".join(group) for group in asked if group]
    count = NUMBERS[len(groups)] if len(groups) < len(NUMBERS) else str(len(groups))
    told = f"{recording} are expected to tell {count} groups of hypotheses apart: {'; '.join(groups)}."
    inside = f"Within a group no {what} within the limits was found that does, whichever is right."
    right = f"The right group is expected at a probability of {expected.after:.2f}"
    if expected.gains:
        return f"{told} {right}. {inside}"
    return f"{told} {right}, which is no more than the first one has today ({expected.today:.2f}). {inside}"


def hypothesis_table(names: Sequence[str], expected: Expected) -> tuple[list[str], list[list[str | float]]]:
    """Heads, and a row for each hypothesis: its probability now, and the evidence for it against the nearest rival, if it is right; where
    groups are told apart, its group, the evidence against the others, and that within it.
    """
    nats = expected.nats + np.diag(np.full(len(names), np.inf))
    now: list[str | float] = [p if p >= 1e-4 else "< 0.0001" for p in expected.before]
    if not expected.by_groups:
        rows: list[list[str | float]] = [[name, now[k], float(nats[k].min())] for k, name in enumerate(names)]
        return ["hypothesis", "probability\nnow", "expected evidence\nif right [nats]"], rows
    rows = []
    for number, group in enumerate(expected.groups, start=1):
        others = [k for k in range(len(names)) if k not in group]
        for k in group:
            within = "" if len(group) == 1 else float(nats[k, group].min())
            rows.append([str(number), names[k], now[k], float(nats[k, others].min()), within])
    heads = [
        "group",
        "hypothesis",
        "probability\nnow",
        "evidence if right,\nother groups [nats]",
        "its own\ngroup [nats]",
    ]
    return heads, rows
