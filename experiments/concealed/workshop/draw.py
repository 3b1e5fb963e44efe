"""Cases of the workshop: a machine, what is concealed in it, sensors as good as the strength asks for; folder and key as everywhere.

The strength is the RMS of what stays of the effect once the free parameters and the start states of the plain model are refitted (in
linearisation, by the machine's own equations), over the outputs' noise: the physics is drawn first and the sensors are made to suit.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.workshop.files import card_text, lose, write_table
from experiments.concealed.workshop.integrate import Experiment, noise_of, simulate
from experiments.concealed.workshop.machines import WORKSHOP
from experiments.concealed.workshop.plant import Array, Concealed, Drive, Entry, Machine, Seen
from experiments.concealed.workshop.visibility import left_by_a_refit

STRENGTHS = {"moderate": (8.0, 20.0), "dominant": (40.0, 100.0), "overwhelming": (300.0, 3000.0)}
WITHOUT, TWO = 0.32, 0.15
"""Shares of the cases with nothing and with two effects concealed."""
GAPS = 0.2
"""Share of the cases with samples missing."""
FINEST, COARSEST = 2e-5, 0.03
"""Noise of a sensor, of the RMS of what it shows."""


@dataclass(frozen=True)
class Drawn:
    """A case: true parameters, what is concealed, noise and resolution (outputs,), recordings, strength as a number and a word."""

    truth: Mapping[str, float]
    plan: Mapping[str, Entry]
    sigma: Array
    resolution: Array
    runs: list[Experiment]
    visibility: float
    word: str


def write_workshop(
    seed: int,
    cases: int,
    out: Path,
    *,
    effects: Sequence[tuple[str, ...]] = (),
    strength: str,
    tell: Callable[[str], None],
) -> None:
    """Draw and write `cases` cases, going round the machines, and round `effects` where there are any.

    Raises:
        ValueError: no machine has all effects of a case.
    """
    for number in range(cases):
        rng = np.random.default_rng(SeedSequence([seed, 5, number]))
        wanted = effects[number % len(effects)] if effects else None
        able = [m for m in WORKSHOP.values() if set(wanted or ()) <= set(m.catalogue)]
        if not able:
            known = sorted({name for m in WORKSHOP.values() for name in m.catalogue})
            raise ValueError(f"--effects: no machine has {'+'.join(wanted or ())}; there are none, {', '.join(known)}")
        machine = able[(number + seed) % len(able)]
        plan = None if wanted is None else {name: machine.catalogue[name] for name in wanted}
        folder = out / f"c{number:03d}"
        key = write_case(folder, machine, rng, seed=seed, number=number, strength=strength, plan=plan)
        tell(f"c{number:03d} {machine.name} {'+'.join(key['effects'])} {key['strength']} {key['visibility']:.3g}")


def write_case(
    folder: Path,
    machine: Machine,
    rng: Generator,
    *,
    seed: int,
    number: int,
    strength: str,
    plan: Mapping[str, Entry] | None = None,
) -> dict[str, Any]:
    """Draw, simulate and write one case, with what is concealed drawn as well where there is no `plan`. Returns its key."""
    while True:
        made = _draw(machine, rng, strength, plan)
        if made is not None:
            break
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(machine.model_file, folder / "model.py")
    if rng.random() < GAPS:
        for run in made.runs:
            lose(rng, run.outputs)
    channels = (*machine.inputs, *machine.outputs)
    steps = [0.0] * len(machine.inputs) + list(made.resolution)
    scales = [step if c.counts else c.scale for c, step in zip(channels, steps, strict=True)]
    for j, run in enumerate(made.runs):
        write_table(folder / f"e{j}.csv", machine, run, scales)
    (folder / "dataset.toml").write_text(card_text(machine, rng, made.truth, scales), encoding="utf-8")
    whole = {name: (entry, *entry.beside) for name, entry in made.plan.items()}
    names = [name + "+" * i for name, some in whole.items() for i in range(len(some))]
    entries = [entry for some in whole.values() for entry in some]
    key = {
        "effects": names or ["none"],
        "accept": [[list(pair) for pair in e.accept] for e in entries] or [[]],
        "near": [[list(pair) for pair in e.near] for e in entries] or [[]],
        "ports": [list(e.places) for e in entries] or [[]],
        "outside": [e.outside for e in entries] or [False],
        "sigma": {c.name: float(s) for c, s in zip(machine.outputs, made.sigma, strict=True)},
        "machine": machine.name,
        "strength": made.word,
        "visibility": made.visibility,
        "resolution": list(made.resolution),
        "seed": seed,
        "number": number,
        "truth": made.truth,
    }
    (folder / "key.json").write_text(json.dumps(key, indent=1, default=float), encoding="utf-8")
    return key


def _draw(machine: Machine, rng: Generator, strength: str, given: Mapping[str, Entry] | None) -> Drawn | None:
    """One draw; None where the machine cannot be simulated so, or the effect cannot be seen."""
    truth = machine.draw_truth(rng)
    drives = [machine.drive(rng, j, truth) for j in range(machine.experiments)]
    starts = [machine.start(rng, truth) for _ in drives]
    plain = _runs(machine, truth, drives, starts, Concealed())
    seen = Seen(
        truth,
        np.stack([run.states for run in plain]),
        np.stack([run.inputs for run in plain]),
        np.stack([run.outputs for run in plain]),
    )
    plan = _plan(machine, rng) if given is None else given
    word = strength if strength != "drawn" else str(rng.choice(list(STRENGTHS)))
    hidden = Concealed()
    for entry in plan.values():
        hidden = hidden.join(entry.draw(rng, seen))
    usual = np.array([run.outputs.std(axis=0) for run in plain]).mean(axis=0)
    if plan:
        clean = _runs(machine, truth, drives, starts, hidden)
        if not all(np.isfinite(run.outputs).all() for run in clean):
            return None
        if machine.unstable:  # what the effect does under the same feedback
            left = float(
                np.sqrt(np.mean([((c.outputs - q.outputs) / usual) ** 2 for c, q in zip(clean, plain, strict=True)]))
            )
        else:
            left = left_by_a_refit(machine, truth, clean, starts, usual)
        share = left / float(np.exp(rng.uniform(*np.log(STRENGTHS[word]))))
    else:
        word, left = "none", 0.0
        share = float(np.exp(rng.uniform(np.log(1e-4), np.log(2e-2))))
    share = min(max(share, FINEST), COARSEST)
    if plan and left / share < 5.0:
        return None
    uneven = np.exp(rng.uniform(-0.5, 0.5, len(usual)))
    sigma = share * usual * uneven / np.sqrt(np.mean(uneven**2))
    resolution = np.array([s * np.sqrt(12.0) if c.counts else 0.0 for s, c in zip(sigma, machine.outputs, strict=True)])
    noise = [noise_of(rng, np.where(resolution > 0, 0.2 * sigma, sigma), machine.samples) for _ in drives]
    runs = [
        simulate(machine, truth, drive, hidden, start=start, noise=n, resolution=list(resolution))
        for drive, start, n in zip(drives, starts, noise, strict=True)
    ]
    if not all(np.isfinite(run.outputs).all() for run in runs):
        return None
    return Drawn(truth, plan, sigma, resolution, runs, left / share, word)


def _plan(machine: Machine, rng: Generator) -> dict[str, Entry]:
    kind = rng.random()
    count = 0 if kind < WITHOUT else 2 if kind > 1.0 - TWO else 1
    found: dict[str, Entry] = {}
    while len(found) < count:
        name = str(rng.choice(list(machine.catalogue)))
        if machine.catalogue[name].family not in {e.family for e in found.values()}:
            found[name] = machine.catalogue[name]
    return found


def _runs(
    machine: Machine, truth: Mapping[str, float], drives: list[Drive], starts: list[list[float]], hidden: Concealed
) -> list[Experiment]:
    silent = np.zeros((machine.samples, len(machine.outputs)))
    still = [0.0] * len(machine.outputs)
    return [
        simulate(machine, truth, drive, hidden, start=start, noise=silent, resolution=still)
        for drive, start in zip(drives, starts, strict=True)
    ]
