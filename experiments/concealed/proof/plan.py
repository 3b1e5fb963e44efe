"""Which cases a proof has: the standard set and the quick one. Drawn from the seed, in an order that tells nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.effects import Effect
from experiments.concealed.excitation import EXPERIMENTS
from experiments.concealed.machines import MACHINES
from experiments.concealed.proof.errors import ProofError
from experiments.concealed.scaling import WORDS

LIBRARY, NONE, PAIR, OUTSIDE = "library", "none", "two effects", "outside"
EXCITATION, NOISE = "excitation", "noise"
SECTIONS = (LIBRARY, NONE, PAIR, OUTSIDE, EXCITATION, NOISE)
NOISES = (0.3, 1.0, 3.0, 10.0)
"""Of the sweep, times the usual noise."""


@dataclass(frozen=True)
class Planned:
    """One case to draw. Cases with the same `number` are the same draw: only the role of the experiments or the noise differs."""

    section: str
    machine: str
    plan: tuple[str, ...]
    words: tuple[str, ...]
    number: int
    estimation: str = "estimation"
    noise: float = 1.0


def mechanism(effect: Effect) -> str:
    """The library's name for an effect, `unknown` where it has none."""
    return next((name for port, name in effect.accept if port == effect.port), effect.accept[0][1])


def by_mechanism() -> dict[str, list[tuple[str, str]]]:
    """(machine, effect) by the mechanism that it is, those outside the library left out."""
    found: dict[str, list[tuple[str, str]]] = {}
    for machine in MACHINES.values():
        for effect in machine.catalogue.values():
            if not effect.outside:
                found.setdefault(mechanism(effect), []).append((machine.name, effect.name))
    return found


def plans(kind: str, seed: int) -> list[Planned]:
    """The cases of the set `kind` ("standard" or "quick") in their order. Raises ProofError for another kind."""
    if kind not in ("standard", "quick"):
        raise ProofError(f"--set {kind!r}: no such set; expected standard or quick")
    rng = np.random.default_rng(SeedSequence([seed, 0]))
    found = _standard(rng) if kind == "standard" else _quick(rng)
    return [found[i] for i in rng.permutation(len(found))]


def _standard(rng: Generator) -> list[Planned]:
    found: list[Planned] = []
    for choices in by_mechanism().values():
        for word, (machine, effect) in zip(WORDS, _spread(rng, choices), strict=True):
            found.append(Planned(LIBRARY, machine, (effect,), (word,), len(found)))
    for machine in MACHINES:
        found += [Planned(NONE, machine, (), (), len(found) + i) for i in range(10)]
    for machine, count in (("arm", 5), ("stage", 2), ("pendulum", 2)):
        for _ in range(count):
            found.append(Planned(PAIR, machine, _pair(rng, machine), ("moderate", "moderate"), len(found)))
    for i, (machine, effect) in enumerate(_outside(rng, {"arm": 4, "stage": 3, "pendulum": 3})):
        found.append(Planned(OUTSIDE, machine, (effect,), (("moderate", "dominant")[i % 2],), len(found)))
    for effect in _effects(rng, "arm", 2):
        number = len(found)
        found += [Planned(EXCITATION, "arm", (effect,), ("moderate",), number, estimation=e) for e in EXPERIMENTS]
    for machine, effect in (("arm", _effects(rng, "arm", 1)[0]), ("pendulum", _effects(rng, "pendulum", 1)[0])):
        number = len(found)
        found += [Planned(NOISE, machine, (effect,), ("moderate",), number, noise=n) for n in NOISES]
    return found


def _quick(rng: Generator) -> list[Planned]:
    """Each machine with one effect, and without; one effect from outside the library; one pair."""
    found: list[Planned] = []
    for machine in MACHINES:
        found.append(Planned(NONE, machine, (), (), len(found)))
        found.append(Planned(LIBRARY, machine, tuple(_effects(rng, machine, 1)), ("moderate",), len(found)))
    found.append(Planned(OUTSIDE, "stage", (_outside(rng, {"stage": 1})[0][1],), ("moderate",), len(found)))
    found.append(Planned(PAIR, "pendulum", _pair(rng, "pendulum"), ("moderate", "moderate"), len(found)))
    return found


def _spread(rng: Generator, choices: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """One choice for each strength, on different machines as far as there are any."""
    machines = [str(name) for name in rng.permutation(sorted({machine for machine, _ in choices}))]
    taken = [machines[i % len(machines)] for i in range(len(WORDS))]
    order = rng.permutation(len(taken))
    return [_one(rng, [c for c in choices if c[0] == taken[i]]) for i in order]


def _one(rng: Generator, choices: Sequence[tuple[str, str]]) -> tuple[str, str]:
    return choices[int(rng.integers(len(choices)))]


def _effects(rng: Generator, machine: str, count: int) -> list[str]:
    names = [name for name, effect in MACHINES[machine].catalogue.items() if not effect.outside]
    return [names[i] for i in rng.choice(len(names), count, replace=False)]


def _outside(rng: Generator, counts: dict[str, int]) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    for machine, count in counts.items():
        names = [name for name, effect in MACHINES[machine].catalogue.items() if effect.outside]
        found += [(machine, names[i]) for i in rng.choice(len(names), count, replace=False)]
    return found


def _pair(rng: Generator, machine: str) -> tuple[str, str]:
    """Two effects of different families."""
    catalogue = MACHINES[machine].catalogue
    while True:
        first, second = _effects(rng, machine, 2)
        if catalogue[first].family != catalogue[second].family:
            return first, second
