"""Fresh cases on the machines of the proof, with their keys beside: to try things on, not to prove anything by."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.machines import ENGINE, MACHINES, OWN
from experiments.concealed.proof.draw import draw_cases
from experiments.concealed.proof.files import write_json
from experiments.concealed.proof.plan import FRESH, QUIET, Planned
from experiments.concealed.scaling import WORDS
from experiments.concealed.trial_files import KEY

FAMILIES = {"own": tuple(OWN), "mujoco": tuple(ENGINE), **{name: (name,) for name in MACHINES}}
"""Machines by the word of --family."""
WITHOUT = 4
"""One case in so many has nothing concealed."""


def fresh_plans(
    family: str, seed: int, cases: int, *, effects: Sequence[tuple[str, ...]], strength: str
) -> list[Planned]:
    """Going round the machines of a family, and round `effects` (one case each; any of the machine's where there are none).

    `strength` is one of `WORDS`, or "drawn". Raises ValueError where no machine of the family has an effect.
    """
    rng = np.random.default_rng(SeedSequence([seed, 0]))
    machines = FAMILIES[family]
    found = []
    for number in range(cases):
        plan = effects[number % len(effects)] if effects else None
        able = [m for m in machines if plan is None or set(plan) <= set(MACHINES[m].catalogue)]
        if not able:
            known = sorted({name for m in machines for name in MACHINES[m].catalogue})
            raise ValueError(
                f"--effects: no machine of {family} has {'+'.join(plan or ())}; there are none, {', '.join(known)}"
            )
        machine = able[number % len(able)]
        chosen = plan if plan is not None else _any(rng, machine, number)
        words = tuple(str(rng.choice(list(WORDS))) if strength == "drawn" else strength for _ in chosen)
        quiet = QUIET if "overwhelming" in words or (not chosen and rng.random() < 0.5) else 1.0
        found.append(Planned(FRESH, machine, chosen, words, number, quiet=quiet))
    return found


def write_fresh(
    planned: Sequence[Planned], seed: int, out: Path, *, workers: int, progress: Callable[[str], None]
) -> None:
    """Draw, simulate and write the cases, and the keys beside them."""
    for name, key in draw_cases(planned, seed, out, workers=workers, progress=progress).items():
        write_json(out / name / KEY, key)


def _any(rng: Generator, machine: str, number: int) -> tuple[str, ...]:
    if number % WITHOUT == WITHOUT - 1:
        return ()
    names = list(MACHINES[machine].catalogue)
    return (names[int(rng.integers(len(names)))],)
