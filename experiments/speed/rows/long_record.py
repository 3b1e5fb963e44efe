"""Row 10: a diagnosis of a record of a million samples, in which the gear spring stiffens and the model's does not."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from experiments.speed.records import SAMPLE_TIME, arm_values, simulated_records
from experiments.speed.row import Entry, Row, Target
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import CHECKOUT, Settings
from greybox_torch.systems import RobotArm

TITLE = "Diagnosis of a record of a million samples"
NEEDS = Needs()
LONG, HELD_OUT = 1_000_000, 40_000
"""Samples to estimate from, and those of the record that judges."""

NOISE = 0.05
"""Of the measured speed, rad/s."""

MEMORY = 4.0
"""GB that it may take."""

MISSING = ("gear_spring", "nonlinear_stiffness")


def measure(settings: Settings, progress: Progress) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        progress("simulating")
        card = recorded(Path(folder), *((20_000, 8_000) if settings.quick else (LONG, HELD_OUT)))
        progress("diagnosing")
        command = [sys.executable, "-m", "greybox_torch", "diagnose", str(card), "--out", f"{folder}/out"]
        command += ["--time-limit", "3"] if settings.quick else []
        process = subprocess.Popen(command, cwd=CHECKOUT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise RuntimeError(f"the diagnosis ended with {process.returncode}")
        verdict = json.loads((Path(folder) / "out" / "verdict.json").read_text())
    peak, processor = used.ru_maxrss * 1024 / 1e9, used.ru_utime + used.ru_stime
    found = [(effect["port"], effect["mechanism"]) for effect in verdict["effects"]]
    said = ", ".join(f"{mechanism} at {port}" for port, mechanism in found) or "nothing"
    return Row(
        "long_record",
        TITLE,
        entries=(
            Entry("greybox diagnose", verdict["seconds"], ours=True, note=f"{said}; {processor:.0f} s of processor"),
            *(Entry(stage, seconds, ours=True) for stage, seconds in verdict["stages"].items()),
        ),
        targets=(
            Target("peak memory", "at most", MEMORY, peak, " GB"),
            Target("names what is missing, and that alone", "at least", 1.0, float(found == [MISSING]), ""),
        ),
        details={"stages": verdict["stages"], "peak_gb": peak, "processor_s": processor, "effects": found},
    )


def recorded(folder: Path, long: int, held_out: int) -> Path:
    """The card of two simulated records of the arm, of so many samples, for a model without the cubic stiffness."""
    for name, samples, seed in (("long", long, 7), ("check", held_out, 8)):
        records = simulated_records(1, samples, noise=NOISE, seed=seed)
        np.savez(folder / f"{name}.npz", torque=records.u[0], motor_speed=records.y[0])
    names = [parameter.name for parameter in RobotArm().declared_parameters]
    values = dict(zip(names, arm_values(), strict=True)) | {"k_g3": 0.0}
    fixed = "".join(
        f"{n} = {{ value = {float(v)!r}, fixed = {str(n in ('J', 'k_g3')).lower()} }}\n" for n, v in values.items()
    )
    card = folder / "dataset.toml"
    card.write_text(
        f'name = "A long record"\nsample_time = {SAMPLE_TIME}\nhold = "zoh"\n\n[channels]\n'
        'torque = { column = "torque", unit = "N m" }\nmotor_speed = { column = "motor_speed", unit = "rad/s" }\n\n'
        '[[experiment]]\nname = "long"\nfile = "long.npz"\nrole = "estimation"\n\n'
        '[[experiment]]\nname = "check"\nfile = "check.npz"\nrole = "validation"\n\n'
        f'[model]\nname = "robot_arm"\n\n[model.parameters]\n{fixed}'
    )
    return card
