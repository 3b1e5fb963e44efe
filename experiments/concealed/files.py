"""The files of a case: the card, four recordings and the answer key."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from experiments.concealed.case import Case
from experiments.concealed.excitation import EXPERIMENTS, SENSOR_NOISE
from experiments.concealed.plant_arm import PARAMETERS, Recordings

NAMES = {experiment: experiment for experiment in EXPERIMENTS}


def card_text(case: Case, name: str = "Robot arm drive", chosen: Mapping[str, str] = NAMES) -> str:
    """The data set's card: what the tool is told. `chosen` gives the experiments written, and their names on the card."""
    lines = [
        f'name = "{name}"',
        f"sample_time = {case.sample_time}",
        'hold = "zoh"',
        "",
        "[channels]",
        'torque = { column = "u", unit = "N m" }',
        'motor_speed = { column = "y", unit = "rad/s" }',
        "",
    ]
    for experiment, title in chosen.items():
        role = "estimation" if experiment == "estimation" else "validation"
        lines += ["[[experiment]]", f'name = "{title}"', f'file = "{experiment}.csv"', f'role = "{role}"', ""]
    lines += ["[model]", 'name = "robot_arm"', "", "[model.parameters]"]
    for parameter in PARAMETERS:
        fixed = ", fixed = true" if parameter == "J" else ""
        lines.append(f"{parameter} = {{ value = {case.card[parameter]:.6g}{fixed} }}")
    return "\n".join(lines) + "\n"


def key(case: Case) -> dict[str, Any]:
    """The answer key; `score.py` reads effects, accept, near, ports and sigma, the rest is for people."""
    effects = case.effects
    return {
        "effects": list(case.plan) or ["none"],
        "switches": {
            f"{effect.name}.{name}": value
            for effect, switches in zip(effects, case.switches, strict=True)
            for name, value in switches.items()
        },
        "accept": [[list(pair) for pair in effect.accept] for effect in effects] or [[]],
        "near": [[list(pair) for pair in effect.near] for effect in effects] or [[]],
        "ports": [list(effect.ports) for effect in effects] or [[]],
        "strength": list(case.strength),
        "outside": [effect.outside for effect in effects],
        "sigma": SENSOR_NOISE,
        "seed": case.seed,
        "number": case.number,
        "truth": case.truth,
    }


def write_case(
    folder: Path,
    case: Case,
    recordings: Recordings,
    *,
    name: str = "Robot arm drive",
    chosen: Mapping[str, str] = NAMES,
) -> None:
    """Write the folder; numbers in the recordings have five significant digits."""
    folder.mkdir(parents=True, exist_ok=True)
    for experiment in chosen:
        i = EXPERIMENTS.index(experiment)
        table = np.stack([recordings.torque[:, i], recordings.speed[:, i]], axis=1)
        np.savetxt(folder / f"{experiment}.csv", table, fmt="%.5g", delimiter=",", header="u,y", comments="")
    (folder / "dataset.toml").write_text(card_text(case, name, chosen))
    (folder / "key.json").write_text(json.dumps(key(case), indent=1) + "\n")
