"""What was said against what was concealed, by kind of port and mechanism."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.machines import MACHINES
from experiments.concealed.proof.plan import mechanism
from experiments.verdicts.scoring import Scored

NOTHING, NO_VERDICT = "nothing", "no verdict"
KINDS = ("body", "coupling", "actuator", "sensor")


def kind(port: str) -> str:
    """The kind of a port of one of the machines, by its name."""
    first = port.partition(".")[0]
    return first if first in KINDS else "coupling" if port.endswith(("_spring", "shaft")) else "body"


def matrix(found: Sequence[Scored]) -> tuple[list[str], list[str], NDArray[np.int64]]:
    """Labels of the rows (concealed) and columns (said), and counts (rows, columns).

    The columns are all labels there are; the rows are those of them that were concealed, in the same order.

    A right answer counts as what is concealed, whichever of its twins it names. A miss is matched with a finding that is not right,
    if the case has one, else with nothing; findings beyond are matched with nothing concealed.
    """
    pairs: list[tuple[str, str]] = []
    for row in found:
        pairs += _pairs(row)
    order = _order({a for a, _ in pairs} | {b for _, b in pairs})
    rows = [label for label in order if any(a == label for a, _ in pairs)]
    counts = np.zeros((len(rows), len(order)), np.int64)
    for a, b in pairs:
        counts[rows.index(a), order.index(b)] += 1
    return rows, order, counts


def _pairs(row: Scored) -> list[tuple[str, str]]:
    catalogue = MACHINES[row.key["machine"]].catalogue
    concealed = [f"{kind(catalogue[e].port)}: {mechanism(catalogue[e])}" for e in row.effects]
    if row.verdict is None:
        return [(label, NO_VERDICT) for label in concealed or [NOTHING]]
    findings = list(row.findings)
    pairs = []
    left = list(range(len(row.effects)))
    for finding in [f for f in findings if f.right]:
        said = [finding.port, finding.mechanism]
        hit = next(i for i in left if said in [list(pair) for pair in row.key["accept"][i]])
        left.remove(hit)
        pairs.append((concealed[hit], concealed[hit]))
    wrong = [f"{kind(f.port)}: {f.mechanism}" for f in findings if not f.right]
    for i in left:
        pairs.append((concealed[i], wrong.pop(0) if wrong else NOTHING))
    pairs += [(NOTHING, label) for label in wrong]
    return pairs or [(NOTHING, NOTHING)]


def _order(labels: set[str]) -> list[str]:
    """By kind of port, unknowns last within each, then nothing and no verdict."""

    def rank(label: str) -> tuple[int, bool, str]:
        if label in (NOTHING, NO_VERDICT):
            return len(KINDS), label == NO_VERDICT, label
        place, _, name = label.partition(": ")
        return KINDS.index(place), name == "unknown", name

    return sorted(labels, key=rank)
