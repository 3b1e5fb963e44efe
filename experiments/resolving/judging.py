"""What a verdict says of the question, and how far a recording has told the hypotheses apart."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

import greybox_torch as gt
from experiments.verdicts.answers import Pair, hypotheses
from greybox_torch.data import DataSet

SURE = 0.9
"""Probability at which a question counts as decided."""


def is_open(verdict: Mapping[str, Any]) -> bool:
    """Whether the headline is a class, or less sure than that."""
    effects = verdict["effects"]
    return bool(effects) and ("one_of" in effects[0] or effects[0]["probability"] < SURE)


def probability_of(verdict: Mapping[str, Any], right: Collection[Pair]) -> float:
    """What a verdict gives to any of the answers that are right, in the finding that gives most; nothing where it finds nothing."""
    given = [sum(p for pair, p in hypotheses(e).items() if pair in right) for e in verdict["effects"]]
    return max(given, default=0.0)


def also_right(right: Collection[Pair], alike: Collection[Collection[Pair]]) -> set[Pair]:
    """The answers that are right, and those that the design says no input tells from one of them."""
    found = set(right)
    while True:
        more = {p for pair in alike if found & set(pair) for p in pair} - found
        if not more:
            return found
        found |= more


def leading(before: Mapping[Pair, float], alike: Collection[Collection[Pair]]) -> float:
    """The probability of the likeliest hypothesis before a recording, together with those that no input tells from it."""
    return max(sum(before.get(p, 0.0) for p in also_right([one], alike)) for one in before)


def realised(designed: gt.DesignResult, right: int, rival: int, before: DataSet, after: DataSet) -> float:
    """By how many nats a new recording tells the right hypothesis from a rival: both estimated without it, and with it.

    The errors are those before, as many of them independent as the design counted; of a machine with one output.
    """
    variance = float(designed.level[0]) ** 2 * designed.memory

    def cost(index: int, data: DataSet) -> float:
        samples = sum(len(r.signals[next(iter(designed.limits.outputs))]) for r in data.estimation())
        return 0.5 * samples * gt.fit(designed.hypotheses[index], data).to_dict()["statistics"]["mse"] / variance

    gained = {k: cost(k, after) - cost(k, before) for k in (right, rival)}
    return gained[rival] - gained[right]


def pairs_of(designed: gt.DesignResult, found: gt.DiagnosisResult) -> dict[str, Pair]:
    """Port and mechanism of every hypothesis by its name."""
    listed = {f"{r.mechanism} at {r.port}".replace("_", " ").lower(): (r.port, r.mechanism) for r in found.found.rivals}
    return {name: listed[name.replace("_", " ").lower()] for name in designed.names}


def nearest(nats: np.ndarray, right: int, others: Sequence[int]) -> int:
    """Of the rivals that are to be told from the right one, the one that is expected to come closest."""
    return min(others, key=lambda k: float(nats[right, k]))
