"""Fitting, training and diagnosing a machine by the command line; what is there already is not done again."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.make_checkpoints.machines import CHECKOUT, Machine, Network
from experiments.speed.settings import header
from greybox_torch import UserError, load_checkpoint, load_dataset
from greybox_torch.files import write_text

SNAPSHOT = "training.safetensors"
COMMIT = "commit.txt"


@dataclass(frozen=True)
class Made:
    """The folders of a machine's three models. ``tried`` has the result of every training by its network, the chosen one is ``network``."""

    physics: Path
    named: Path
    hybrid: Path
    network: Network
    tried: Mapping[Network, Mapping[str, Any]]

    @property
    def models(self) -> dict[str, Path]:
        """What is kept, by name."""
        return {"physics": self.physics, "named": self.named, "hybrid": self.hybrid}


def made(machine: Machine, work: Path, named: Path | None) -> Made:
    """All models of a machine, under ``work``; ``named`` is the folder of a diagnosis that is there already.

    Raises:
        UserError: that folder holds no diagnosis of this machine's recordings, or one that was stopped, or a command refuses its input.
    """
    folder = work / machine.name
    _command("fit", machine, folder / "physics", "fit.json")
    for network in machine.networks:
        here = folder / network.folder
        resume = ["--resume"] if (here / SNAPSHOT).is_file() else []
        _command("train", machine, here, "train.json", *network.options, *resume)
    if named is None:
        _command("diagnose", machine, folder / "named", "verdict.json")
    else:
        _check_diagnosis(machine, named)
    tried = {network: _read(folder / network.folder / "train.json") for network in machine.networks}
    best = min(tried, key=lambda network: held_out(tried[network]))
    return Made(folder / "physics", named or folder / "named", folder / best.folder, best, tried)


def held_out(result: Mapping[str, Any], penalty: float | str | None = "chosen") -> float:
    """Mean squared error of a training's free run on the held-out stretches; with a ``penalty`` of None that of the physics alone."""
    statistics = result["statistics"]
    wanted = statistics["penalty"] if penalty == "chosen" else penalty
    return next(entry["mse"] for entry in statistics["held_out"] if entry["penalty"] == wanted)


def _command(command: str, machine: Machine, folder: Path, result: str, *options: str) -> None:
    if (folder / result).is_file():
        print(f"{machine.name}: {folder / result} is there already", flush=True)
        return
    arguments = [command, os.path.relpath(machine.card, CHECKOUT), *options, "--out", str(folder.resolve())]
    print(f"{machine.name}: greybox {' '.join(arguments)}", flush=True)
    done = subprocess.run([sys.executable, "-m", "greybox_torch", *arguments], cwd=CHECKOUT, check=False)
    if done.returncode != 0:
        raise UserError(
            f"greybox {command} of {machine.card} ended with exit code {done.returncode}; nothing is kept of it"
        )
    write_text(folder / COMMIT, header()["commit"] + "\n")


def commit(folder: Path) -> str:
    """The commit that the result in ``folder`` was made at, where this module made it."""
    file = folder / COMMIT
    return file.read_text(encoding="utf-8").strip() if file.is_file() else "not recorded"


def _check_diagnosis(machine: Machine, folder: Path) -> None:
    checkpoint, data = load_checkpoint(folder / "model"), load_dataset(machine.card)
    if checkpoint.dataset != data.sha256:
        raise UserError(
            f'{folder / "model.json"}, "dataset": found {checkpoint.dataset[:12]}…, expected {data.sha256[:12]}…, the recordings of '
            f"{machine.card}"
        )
    if not _read(folder / "verdict.json").get("complete"):
        raise UserError(f'{folder / "verdict.json"}: "complete" is not true; expected a diagnosis that ran to its end')


def _read(path: Path) -> dict[str, Any]:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read: {error}; expected the result of a greybox command") from None
