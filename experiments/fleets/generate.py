"""The recordings of a simulated fleet, with a card for each, and the key."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.excitation import multisine
from experiments.concealed.laws import Law, body, drive, dry
from experiments.concealed.plant_body import BodyDrive, BodyPlant
from experiments.fleets.plan import KINDS, Planned

MODEL = Path(__file__).with_name("motor.py")
SAMPLE_TIME = 0.01
NOISE = 0.02
"""Of the measured speed, in rad/s."""
BEFORE = 100
"""Samples that run unrecorded."""
EXPERIMENTS = ("estimation", "validation")
LAWS: dict[str, type[Law]] = {
    "DryCoulomb": dry.DryCoulomb,
    "QuadraticDrag": body.QuadraticDrag,
    "ActuatorDeadzone": drive.ActuatorDeadzone,
}
_CARD = """\
name = "{machine}, {date}"
machine = "{machine}"
recorded = {date}
sample_time = {sample_time}
hold = "zoh"

[channels]
torque = {{ column = "torque", unit = "N m" }}
speed = {{ column = "speed", unit = "rad/s" }}

[[experiment]]
name = "Estimation"
file = "estimation.csv"
role = "estimation"

[[experiment]]
name = "Validation"
file = "validation.csv"
role = "validation"

[model]
name = "../../motor.py:Motor"

[model.parameters]
J = {{ value = {inertia}, fixed = true }}
"""


def write_fleet(planned: Sequence[Planned], out: Path, *, samples: int, seed: int) -> list[Path]:
    """A folder OUT/MACHINE/DATE for each recording, and the model's file in OUT. All are simulated side by side. Returns the cards."""
    out.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(MODEL, out / MODEL.name)
    command, speed = simulate(planned, samples=samples, seed=seed)
    cards, lane = [], 0
    for machine in planned:
        for date in machine.dates:
            folder = out / machine.name / date
            folder.mkdir(parents=True, exist_ok=True)
            for name in EXPERIMENTS:
                table = np.column_stack([command[:, lane], speed[:, lane]])
                np.savetxt(folder / f"{name}.csv", table, "%.6g", ",", header="torque,speed", comments="")
                lane += 1
            cards.append(folder / "dataset.toml")
            told = {"machine": machine.name, "date": date, "sample_time": SAMPLE_TIME, "inertia": machine.inertia}
            cards[-1].write_text(_CARD.format(**told))
    return cards


def both_ways(rng: Generator, samples: int) -> np.ndarray:
    """Steps of a third of a second, and a multisine: 1 N m at the most, mostly."""
    steps = np.repeat(rng.uniform(-0.7, 0.7, samples // 33 + 1), 33)[:samples]
    return steps + 0.2 * multisine(rng, samples, SAMPLE_TIME, 0.3, 10.0)


def simulate(
    planned: Sequence[Planned],
    *,
    samples: int,
    seed: int,
    torque: Callable[[Generator, int], np.ndarray] = both_ways,
) -> tuple[np.ndarray, np.ndarray]:
    """Torque and measured speed (samples, lanes): machine by machine, recording by recording, experiment by experiment.

    Args:
        torque: draws so many samples of it.
    """
    repeat = len(EXPERIMENTS)
    inertia = np.array([m.inertia for m in planned for _ in m.dates for _ in EXPERIMENTS])
    damping = np.repeat([b for m in planned for b in m.damping], repeat)
    lanes = len(inertia)
    plant = BodyPlant(
        inertia,
        damping,
        np.zeros(lanes),
        _laws(planned, repeat),
        output_rows=(1,),
        sensors=("sensor",),
        sample_time=SAMPLE_TIME,
        start_time=-BEFORE * SAMPLE_TIME,
    )
    rng = np.random.default_rng(SeedSequence([seed, 2]))
    total = samples + BEFORE
    commanded = np.column_stack([torque(rng, total) for _ in range(lanes)])
    noise = NOISE * rng.normal(size=(1, total, lanes))
    none = np.zeros(lanes)
    drives = BodyDrive(commanded, np.zeros((total, lanes)), noise, none, none, np.zeros(1))
    run = plant.run(plant.initial_state(none, none), drives)
    return run.command[BEFORE:], run.outputs[0, BEFORE:]


def _laws(planned: Sequence[Planned], repeat: int) -> list[Law]:
    """A law for each effect that occurs, on its lanes; of size zero it does nothing."""
    effects = np.repeat([m.effect for m in planned for _ in m.dates], repeat)
    sizes = np.repeat([size for m in planned for size in m.sizes], repeat)
    found = []
    for name in sorted(set(effects) - {""}):
        kind, lanes = KINDS[str(name)], np.flatnonzero(effects == name)
        found.append(LAWS[kind.law](lanes, {kind.switch: sizes[lanes]}, kind.accept[0][0]))
    return found
