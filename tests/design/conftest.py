"""A motor with dry friction, recorded, and two hypotheses about it: dry friction, and a constant torque."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.diagnosis_result import DiagnosisResult
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.diagnosis.describe.rivals import Rival
from greybox_torch.diagnosis.pipeline import Diagnosis
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.estimate.surroundings import survey
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.stored import stored_effects
from greybox_torch.systems import load_model

STEP, INERTIA, GAIN, DAMPING, LEVEL = 0.01, 0.02, 0.1, 0.05, 0.02


def sticking(voltage: np.ndarray, *, level: float = LEVEL, bias: float = 0.0, start: float = 0.0) -> np.ndarray:
    """The speed of the motor with dry friction that holds it at rest, and a constant torque: Euler's rule with 200 steps a sample."""
    speeds, speed, step = [start], start, STEP / 200
    for v in voltage[:-1]:
        for _ in range(200):
            drive = GAIN * v + bias - DAMPING * speed
            if speed == 0.0 and abs(drive) <= level:
                continue
            direction = np.sign(speed) if speed != 0.0 else np.sign(drive)
            moved = speed + step * (drive - level * direction) / INERTIA
            speed = 0.0 if speed * moved < 0.0 else moved
        speeds.append(speed)
    return np.array(speeds)


@pytest.fixture(scope="session")
def one_way(tmp_path_factory, machines: Path) -> DataSet:
    """Recordings in which the motor turns in one direction only, where dry friction and a constant torque are alike."""
    folder = tmp_path_factory.mktemp("one_way")
    (folder / "my_motor.py").write_text((machines / "motor.py").read_text())
    rng = np.random.default_rng(0)
    for name in ("steps", "more"):
        voltage = np.repeat(rng.uniform(1.5, 3.0, 15), 20)
        rows = np.column_stack([voltage, sticking(voltage, start=2.0) + rng.normal(0, 0.01, len(voltage))])
        np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header="voltage,speed", comments="", fmt="%.12g")
    experiments = "".join(
        f'[[experiment]]\nname = "{name}"\nfile = "{name}.csv"\nrole = "{role}"\n\n'
        for name, role in (("steps", "estimation"), ("more", "validation"))
    )
    (folder / "dataset.toml").write_text(
        f'name = "One way"\nsample_time = {STEP}\n\n[channels]\nvoltage = {{ column = "voltage", unit = "V" }}\n'
        f'speed = {{ column = "speed", unit = "rad/s" }}\n\n{experiments}[model]\nname = "my_motor.py:Motor"\n\n'
        f"[limits]\nseconds = 2.0\nvoltage = {{ lower = -3.0, upper = 3.0 }}\nspeed = {{ lower = -7.0, upper = 7.0 }}\n"
    )
    return load_dataset(folder / "dataset.toml")


@pytest.fixture(scope="session")
def undecided(one_way: DataSet) -> DiagnosisResult:
    """A diagnosis by hand that leaves dry friction and a constant torque at the rotor."""
    own, values = load_model(str(one_way.model)), {"J": INERTIA, "k": GAIN, "b": DAMPING}
    own.set_values(values)
    problem = make_problem(one_way, own, one_way.estimation())
    around, starts = survey(own, problem, simulator_for(problem)), {"steps": {"speed": 2.0}}
    friction = rival(own, around, CoulombFriction(), 0.5, {**values, "F_c": LEVEL, "v_0": 0.05}, starts)
    torque = rival(own, around, ConstantBias(), 0.47, {**values, "bias": -LEVEL}, starts)
    effects = stored_effects(friction.model)
    verdict = Verdict("One way", "Motor", 0, 1.0, 0.97, (), {"start": (), "refit": (), "augmented": ()}, (), {}, ())
    diagnosis = Diagnosis(verdict, friction.model, dict(friction.values), starts, effects, (friction, torque))
    return DiagnosisResult(one_way, own, diagnosis)


def rival(model, around, law, probability: float, values: dict[str, float], starts) -> Rival:
    """A hypothesis with some values, by the parameters' own names."""
    made = AugmentedModel(model.plain, [Attachment("rotor", law)], around)
    held = {p.name: values.get(p.name.split(".")[-1], p.value) for p in made.declared_parameters}
    return Rival("rotor.coulomb_friction", "rotor", law.name, probability, made, held, starts)
