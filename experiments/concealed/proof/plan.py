"""Which cases a proof has: the standard set and the quick one. Drawn from the seed, in an order that tells nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.effects import Effect
from experiments.concealed.excitation import EXPERIMENTS
from experiments.concealed.machines import ENGINE, MACHINES, OWN
from experiments.concealed.machines.base import Machine
from experiments.concealed.proof.errors import ProofError

LIBRARY, NONE, PAIR, OUTSIDE = "library", "none", "two effects", "outside"
EXCITATION, NOISE, RICHER, OVERWHELMING = "excitation", "noise", "richer laws", "overwhelming"
FRESH = "fresh"
"""Section of cases that belong to no proof."""
QUIET = 0.03
"""Of cases with good sensors (an encoder): what noise and nuisances are multiplied with."""
SECTIONS = (LIBRARY, NONE, PAIR, OUTSIDE, RICHER, OVERWHELMING, EXCITATION, NOISE)
NOISES = (0.3, 1.0, 3.0, 10.0)
"""Of the sweep, times the usual noise."""


@dataclass(frozen=True)
class Planned:
    """One case to draw. Cases with the same `number` are the same draw: only the role of the experiments or the noise differs.

    `quiet`: what the noise of the sensors and all nuisances are multiplied with.
    """

    section: str
    machine: str
    plan: tuple[str, ...]
    words: tuple[str, ...]
    number: int = 0
    estimation: str = "estimation"
    noise: float = 1.0
    quiet: float = 1.0


Draw = tuple[object, Planned]
"""A planned case, and what tells its draw from others."""
USUAL_WORDS = ("weak", "moderate", "dominant")


def mechanism(effect: Effect) -> str:
    """The library's name for an effect, `unknown` where it has none."""
    return effect.own[1]


def by_mechanism(machines: Mapping[str, Machine] = OWN) -> dict[str, list[tuple[str, str]]]:
    """(machine, effect) by the mechanism that it is, those outside the library left out."""
    found: dict[str, list[tuple[str, str]]] = {}
    for machine in machines.values():
        for effect in machine.catalogue.values():
            if not effect.outside:
                found.setdefault(mechanism(effect), []).append((machine.name, effect.name))
    return found


def plans(kind: str, seed: int) -> list[Planned]:
    """The cases of the set `kind` ("standard" or "quick") in their order. Raises ProofError for another kind."""
    if kind not in ("standard", "quick"):
        raise ProofError(f"--set {kind!r}: no such set; expected standard or quick")
    rng = np.random.default_rng(SeedSequence([seed, 0]))
    drawn = _standard(rng) if kind == "standard" else _quick(rng)
    numbers: dict[object, int] = {}  # cases that share a draw have one number
    found = [replace(plan, number=numbers.setdefault(draw, len(numbers))) for draw, plan in drawn]
    return [found[i] for i in rng.permutation(len(found))]


def _standard(rng: Generator) -> Iterator[Draw]:
    yield from _library(rng)
    for machine in MACHINES:
        for i in range(10 if machine in OWN else 5):
            yield _case(NONE, machine, quiet=QUIET if i % 2 else 1.0)
    for machine, count in (("arm", 5), ("stage", 2), ("pendulum", 2), *((machine, 1) for machine in ENGINE)):
        for _ in range(count):
            yield _case(PAIR, machine, *_pair(rng, machine), word="moderate")
    for i, (machine, effect) in enumerate(
        _outside(rng, {"arm": 4, "stage": 3, "pendulum": 3} | dict.fromkeys(ENGINE, 1))
    ):
        yield _case(OUTSIDE, machine, effect, word=("moderate", "dominant")[i % 2])
    for machine, effect in _sharp(rng, 9):
        yield _case(RICHER, machine, effect, word=str(rng.choice(["moderate", "dominant"])))
    yield from _overwhelming(rng)
    for effect in _effects(rng, "arm", 2):
        for experiment in EXPERIMENTS:
            yield (EXCITATION, effect), Planned(EXCITATION, "arm", (effect,), ("moderate",), estimation=experiment)
    for machine in ("arm", "pendulum"):
        effect = _effects(rng, machine, 1)[0]
        for noise in NOISES:
            yield (NOISE, machine), Planned(NOISE, machine, (effect,), ("moderate",), noise=noise)


def _library(rng: Generator) -> Iterator[Draw]:
    """Every mechanism at three strengths on the plants that are written here; six effects of every machine in MuJoCo."""
    for choices in by_mechanism().values():
        for word, (machine, effect) in zip(USUAL_WORDS, _spread(rng, choices, len(USUAL_WORDS)), strict=True):
            yield _case(LIBRARY, machine, effect, word=word)
    for machine in ENGINE:
        for i, effect in enumerate(_effects(rng, machine, 6)):
            yield _case(LIBRARY, machine, effect, word=USUAL_WORDS[i % len(USUAL_WORDS)])


def _overwhelming(rng: Generator) -> Iterator[Draw]:
    """Every mechanism once, and four effects of every machine in MuJoCo, seen by good sensors."""
    for choices in by_mechanism().values():
        yield _case(OVERWHELMING, *_one(rng, choices), word="overwhelming", quiet=QUIET)
    for machine in ENGINE:
        for effect in _effects(rng, machine, 4):
            yield _case(OVERWHELMING, machine, effect, word="overwhelming", quiet=QUIET)


def _quick(rng: Generator) -> Iterator[Draw]:
    """Each machine that is written here with one effect, and without; one effect from outside the library; one pair; two in MuJoCo."""
    for machine in OWN:
        yield _case(NONE, machine)
        yield _case(LIBRARY, machine, *_effects(rng, machine, 1), word="moderate")
    yield _case(OUTSIDE, "stage", _outside(rng, {"stage": 1})[0][1], word="moderate")
    yield _case(PAIR, "pendulum", *_pair(rng, "pendulum"), word="moderate")
    yield _case(NONE, "engine_cart", quiet=QUIET)
    yield _case(OVERWHELMING, "engine_pendulum", *_effects(rng, "engine_pendulum", 1), word="overwhelming", quiet=QUIET)


def _case(section: str, machine: str, *effects: str, word: str = "", quiet: float = 1.0) -> Draw:
    """A case that is a draw of its own."""
    return object(), Planned(section, machine, effects, (word,) * len(effects), quiet=quiet)


def _spread(rng: Generator, choices: Sequence[tuple[str, str]], count: int) -> list[tuple[str, str]]:
    """`count` choices, on different machines as far as there are any."""
    machines = [str(name) for name in rng.permutation(sorted({machine for machine, _ in choices}))]
    taken = [machines[i % len(machines)] for i in range(count)]
    order = rng.permutation(len(taken))
    return [_one(rng, [c for c in choices if c[0] == taken[i]]) for i in order]


def _one(rng: Generator, choices: Sequence[tuple[str, str]]) -> tuple[str, str]:
    return choices[int(rng.integers(len(choices)))]


def _sharp(rng: Generator, count: int) -> list[tuple[str, str]]:
    """Effects whose law is richer than the library's, on the plants that are written here."""
    names = [(m.name, e.name) for m in OWN.values() for e in m.catalogue.values() if e.sharp]
    return [names[i] for i in rng.permutation(len(names))[:count]]


def _effects(rng: Generator, machine: str, count: int) -> list[str]:
    names = [name for name, effect in MACHINES[machine].catalogue.items() if not effect.outside]
    return [names[i] for i in rng.choice(len(names), count, replace=False)]


def _outside(rng: Generator, counts: dict[str, int]) -> list[tuple[str, str]]:
    """So many of each machine, or all that it has."""
    found: list[tuple[str, str]] = []
    for machine, count in counts.items():
        names = [name for name, effect in MACHINES[machine].catalogue.items() if effect.outside]
        found += [(machine, names[i]) for i in rng.permutation(len(names))[:count]]
    return found


def _pair(rng: Generator, machine: str) -> tuple[str, str]:
    """Two effects of different families."""
    catalogue = MACHINES[machine].catalogue
    while True:
        first, second = _effects(rng, machine, 2)
        if catalogue[first].family != catalogue[second].family:
            return first, second
