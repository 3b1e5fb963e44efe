"""The folder of a trial: the card, four recordings, the nominal model; and the key, which is kept apart."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path
from typing import Any

import numpy as np

from experiments.concealed.effects import Pair
from experiments.concealed.excitation import EXPERIMENTS
from experiments.concealed.machines.base import LANES, Run, Trial
from experiments.concealed.visibility import word

KEY = "key.json"


def card_text(trial: Trial) -> str:
    """What the tool is told."""
    machine = trial.machine
    lines = [
        f'name = "{machine.title}"',
        f"sample_time = {machine.sample_time}",
        'hold = "zoh"',
        "",
        "[channels]",
        *(f'{c.name} = {{ column = "{c.column}", unit = "{c.unit}" }}' for c in (*machine.inputs, *machine.outputs)),
        "",
    ]
    for experiment in EXPERIMENTS:
        role = "estimation" if experiment == trial.estimation else "validation"
        # named by what they are, not by the role that they have in most trials
        title = f"Experiment {EXPERIMENTS.index(experiment) + 1}"
        lines += ["[[experiment]]", f'name = "{title}"', f'file = "{_file(experiment)}"', f'role = "{role}"', ""]
    lines += ["[model]", f'name = "{machine.model}"', "", "[model.parameters]"]
    for parameter in machine.parameters:
        fixed = ", fixed = true" if parameter in machine.known else ""
        lines.append(f"{parameter} = {{ value = {trial.card[parameter]:.6g}{fixed} }}")
    return "\n".join(lines) + "\n"


def write(folder: Path, trial: Trial, run: Run) -> None:
    """Write card, recordings and, where the machine is not built in, the nominal model. Seven significant digits."""
    machine = trial.machine
    folder.mkdir(parents=True, exist_ok=True)
    header = ",".join(c.column for c in (*machine.inputs, *machine.outputs))
    for j in range(LANES):
        table = np.column_stack([run.command[..., j], *run.outputs[:, :, j]])[machine.before :]
        np.savetxt(folder / _file(EXPERIMENTS[j]), table, fmt="%.7g", delimiter=",", header=header, comments="")
    if machine.model_file is not None:
        shutil.copyfile(machine.model_file, folder / "model.py")
    (folder / "dataset.toml").write_text(card_text(trial), encoding="utf-8")


def key(trial: Trial) -> dict[str, Any]:
    """The answer key. `sigma`, what even the true model leaves, is a number, or one by output where a machine has several."""
    effects, names = trial.effects, [c.name for c in trial.machine.outputs]
    sigma = dict(zip(names, trial.sigma, strict=True))
    return {
        "effects": list(trial.plan) or ["none"],
        "switches": {
            f"{effect.name}.{name}": value
            for effect, switches in zip(effects, trial.switches, strict=True)
            for name, value in switches.items()
        },
        "accept": [_pairs(e.accept, e.alone if len(effects) == 1 else ()) for e in effects] or [[]],
        "own": [list(e.own) for e in effects],
        "near": [_pairs(e.near, e.alone if len(effects) > 1 else ()) for e in effects] or [[]],
        "ports": [list(effect.ports) for effect in effects] or [[]],
        "outside": [effect.outside for effect in effects],
        "sigma": sigma if len(sigma) > 1 else trial.sigma[0],
        "machine": trial.machine.name,
        "section": trial.section,
        "estimation": trial.estimation,
        "noise": trial.noise,
        "quiet": trial.quiet,
        "visibility": trial.visibility,
        "beside": list(trial.beside),
        "strength": word(trial.visibility) if effects else "none",
        "seed": trial.seed,
        "number": trial.number,
        "truth": trial.truth,
    }


def _pairs(*groups: tuple[Pair, ...]) -> list[list[str]]:
    return [list(pair) for group in groups for pair in group]


def digest(folder: Path) -> str:
    """SHA-256 over names and contents of a trial's files, the key left out."""
    total = hashlib.sha256()
    for file in sorted(folder.rglob("*")):
        if file.is_file() and file.name != KEY and "__pycache__" not in file.parts:
            total.update(f"{file.relative_to(folder).as_posix()}\0{file.stat().st_size}\0".encode())
            total.update(file.read_bytes())
    return total.hexdigest()


def _file(experiment: str) -> str:
    return f"experiment{EXPERIMENTS.index(experiment) + 1}.csv"
