"""Short recordings with and without what the fleet says beforehand: `python -m experiments.fleets.short --machines 24 --out results/short`.

What is known beforehand decides between names, so it can help where recordings leave several open. These do by the way they were made: in
production a machine turns one way only. Dry friction, a dead zone of the drive, a constant load and an offset of the drive are then one and
the same constant torque, however long the recording is; only recordings in both directions, as at commissioning, tell them apart.

Three types of machines are drawn, each with an effect that four in five of them have and others that the rest has. Thirty machines of a
type were commissioned, which gives its table ``[beliefs]`` (as `greybox fleet` suggests it); further ones have two short production
recordings each, and are diagnosed without the table and with it. Writes OUT/short.json.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator, SeedSequence

import greybox_torch as gt
from experiments.concealed.excitation import multisine
from experiments.fleets.generate import MODEL, SAMPLE_TIME, simulate
from experiments.fleets.plan import KINDS, Planned
from experiments.speed.settings import header

DOMINANT = 0.8
"""Share of the machines of a type that have the effect of the type."""

COMMISSIONED = 30
TWICE, HIGHEST = 2, 0.95
"""Machines that an effect has to be found at, and the strongest belief that is suggested."""

ROLES = ("estimation", "validation")


def one_way(rng: Generator, samples: int) -> np.ndarray:
    """Torque of a machine that turns one way: 0.6 N m, steps of 0.15 N m around it, and a small multisine."""
    steps = np.repeat(rng.uniform(-0.15, 0.15, samples // 33 + 1), 33)[:samples]
    return 0.6 + steps + 0.05 * multisine(rng, samples, SAMPLE_TIME, 0.3, 10.0)


def draw(count: int, seed: int) -> tuple[list[Planned], list[dict[str, float]]]:
    """Further machines, types in turn, and for each the beliefs that the commissioned ones of its type give."""
    rng = np.random.default_rng(SeedSequence([seed, 0]))
    beliefs = {name: _believed(rng, name) for name in KINDS}
    machines, given = [], []
    for k in range(count):
        of_type = list(KINDS)[k % len(KINDS)]
        effect = _effect(rng, of_type)
        size = KINDS[effect].size * float(np.exp(rng.normal(0.0, 0.15)))
        inertia, damping = 0.02 * float(np.exp(rng.uniform(-0.2, 0.2))), 0.05 * float(np.exp(rng.uniform(-0.2, 0.2)))
        machines.append(Planned(f"s{k:03d}", effect, inertia, ("2026-12-01",), (size,), (damping,)))
        given.append(beliefs[of_type])
    return machines, given


def _effect(rng: Generator, of_type: str) -> str:
    others = [name for name in KINDS if name != of_type]
    return of_type if rng.random() < DOMINANT else str(rng.choice(others))


def _believed(rng: Generator, of_type: str) -> dict[str, float]:
    """By the rule that `greybox fleet` documents (rule of succession), as recordings of commissioning show every effect by its name."""
    counts = Counter("/".join(KINDS[_effect(rng, of_type)].accept[0]) for _ in range(COMMISSIONED))
    return {key: round(min(HIGHEST, (k + 1) / (k + 2)), 3) for key, k in counts.most_common() if k >= TWICE}


def judged(found: gt.DiagnosisResult, machine: Planned) -> dict[str, Any]:
    """Whether the leading name is right, and what it said."""
    effects = sorted(found.effects, key=lambda e: -e.size)
    if not effects:
        return {"right": False, "said": "nothing" if not found.verdict.mismatch else "unknown", "probability": None}
    named = (effects[0].port, effects[0].mechanism)
    right = named in KINDS[machine.effect].accept
    return {"right": right, "said": " ".join(named), "probability": effects[0].probability}


def data_of(machine: Planned, torque: np.ndarray, speed: np.ndarray) -> gt.DataSet:
    """The two recordings (samples, 2) of a machine."""
    recordings = [
        gt.Recording.from_arrays(role, {"torque": u, "speed": y}, sample_time=SAMPLE_TIME, role=role)
        for role, u, y in zip(ROLES, torque.T, speed.T, strict=True)
    ]
    return gt.DataSet(recordings, name=machine.name, parameters={"J": {"value": machine.inertia, "fixed": True}})


def _told(rows: list[dict[str, Any]], chosen: argparse.Namespace) -> dict[str, Any]:
    """How many leading names are right in each way, of those given, and their Brier score."""
    told: dict[str, Any] = {
        "about": header(),
        "machines": len(rows),
        "samples": chosen.samples,
        "seed": chosen.seed,
    }
    for way in ("without", "with"):
        said = [row[way] for row in rows if row[way]["probability"] is not None]
        brier = float(np.mean([(one["probability"] - one["right"]) ** 2 for one in said])) if said else None
        told[way] = {"right": sum(row[way]["right"] for row in rows), "named": len(said), "brier": brier}
    return told


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machines", type=int, default=24)
    parser.add_argument("--samples", type=int, default=180, help="of each of the two recordings")
    parser.add_argument("--seed", type=int, default=177)
    parser.add_argument("--out", type=Path, default=Path("results/short"))
    chosen = parser.parse_args(arguments)
    shutil.rmtree(chosen.out, ignore_errors=True)
    chosen.out.mkdir(parents=True)
    machines, given = draw(chosen.machines, chosen.seed)
    torque, speed = simulate(machines, samples=chosen.samples, seed=chosen.seed, torque=one_way)
    model, rows = gt.load_model(f"{MODEL}:Motor"), []
    for k, (machine, beliefs) in enumerate(zip(machines, given, strict=True)):
        data = data_of(machine, torque[:, 2 * k : 2 * k + 2], speed[:, 2 * k : 2 * k + 2])
        row = {"effect": machine.effect, "size": machine.sizes[0], "beliefs": beliefs}
        row |= {
            way: judged(gt.diagnose(model, data, beliefs=b), machine)
            for way, b in (("without", None), ("with", beliefs))
        }
        rows.append(row)
        (chosen.out / "short.json").write_text(json.dumps({**_told(rows, chosen), "rows": rows}, indent=1))
        print(row, file=sys.stderr, flush=True)
    print(json.dumps(_told(rows, chosen), indent=1))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
