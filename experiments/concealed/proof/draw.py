"""From a plan to sealed cases: every trial drawn, scaled, simulated and written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from importlib.util import find_spec
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import SeedSequence

from experiments.concealed.machines import ENGINE, MACHINES
from experiments.concealed.machines.base import Run, Trial
from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.plan import Planned
from experiments.concealed.scaling import WORDS, calibrate
from experiments.concealed.trial_files import key, write


def draw_cases(
    planned: Sequence[Planned],
    seed: int,
    folder: Path,
    *,
    workers: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> dict[str, dict[str, Any]]:
    """Write every case into its folder c000, c001, ... in the order of the plan; the keys by name. One process a machine.

    Raises ProofError where a machine needs an engine that is not installed.
    """
    if any(plan.machine in ENGINE for plan in planned) and find_spec("mujoco") is None:
        raise ProofError("mujoco is not installed; expected the extra [proof], which simulates a part of the machines")
    keys: dict[str, dict[str, Any]] = {}
    own = {m: {f"c{i:03d}": p for i, p in enumerate(planned) if p.machine == m} for m in MACHINES}
    own = {machine: cases for machine, cases in own.items() if cases}
    progress("drawing and simulating: " + ", ".join(f"{machine} {len(cases)} cases" for machine, cases in own.items()))
    if workers < 2:
        for machine, cases in own.items():
            keys.update(_written(machine, cases, seed, folder))
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            for done in [pool.submit(_written, machine, cases, seed, folder) for machine, cases in own.items()]:
                keys.update(done.result())
    return dict(sorted(keys.items()))


def _written(machine: str, own: dict[str, Planned], seed: int, folder: Path) -> dict[str, dict[str, Any]]:
    keys = {}
    for name, (trial, run) in _simulated(machine, own, seed).items():
        write(folder / name, trial, run)
        keys[name] = key(trial)
    return keys


def _simulated(machine: str, own: dict[str, Planned], seed: int) -> dict[str, tuple[Trial, Run]]:
    """Trials of one machine, side by side. Cases of one draw are scaled once, at the usual noise, and then only vary it."""
    firsts: dict[int, Trial] = {}
    for plan in own.values():
        if plan.number not in firsts:
            firsts[plan.number] = _drawn(machine, plan, seed, targets=_targets(plan, seed))
    trials = list(firsts.values())
    runs = dict(zip(firsts, calibrate(MACHINES[machine], trials), strict=True))
    noisy = {name: _again(machine, plan, seed, firsts[plan.number]) for name, plan in own.items() if plan.noise != 1.0}
    noisy_runs = dict(zip(noisy, calibrate(MACHINES[machine], list(noisy.values())) if noisy else [], strict=True))
    found = {}
    for name, plan in own.items():
        if name in noisy:
            found[name] = (noisy[name], noisy_runs[name])
        else:
            trial = replace(firsts[plan.number], name=name, section=plan.section, estimation=plan.estimation)
            found[name] = (trial, runs[plan.number])
    return found


def _drawn(machine: str, plan: Planned, seed: int, *, noise: float = 1.0, targets: tuple[float, ...] = ()) -> Trial:
    return MACHINES[machine].draw(
        seed, plan.number, plan.plan, noise=noise, quiet=plan.quiet, section=plan.section, targets=targets
    )


def _again(machine: str, plan: Planned, seed: int, first: Trial) -> Trial:
    """The same draw with more or less noise, its effects as strong as they were."""
    trial = _drawn(machine, plan, seed, noise=plan.noise)
    trial.scales = list(first.scales)
    return trial


def _targets(plan: Planned, seed: int) -> tuple[float, ...]:
    """Visibilities to aim at, even on a logarithmic scale within the words' ranges."""
    rng = np.random.default_rng(SeedSequence([seed, 1, plan.number]))
    return tuple(float(np.exp(rng.uniform(*np.log(WORDS[word])))) for word in plan.words)
