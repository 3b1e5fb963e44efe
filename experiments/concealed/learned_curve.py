"""Is the curve that a network learns the true one? A hybrid trained on a case whose concealed effect is friction over speed.

    python -m experiments.concealed.generate CASES --cases 2 --effects speed_bump,speed_waves --seed 7
    python -m experiments.concealed.learned_curve CASES/c000 [--port motor] [--units 12] [--seed 0]

What is compared is all friction of the machine at a speed, the network's and the physics' together: bodies that turn alike can pass
friction on to one another, and the network and the parameters of friction beside it too. The key is read once the training is over.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from experiments.concealed.catalogue.arm import CATALOGUE
from greybox_torch import TrainingSettings, load_dataset, load_model, train_hybrid
from greybox_torch.training import Trained

VISITED = 0.98
"""Share of the samples of the estimation experiment that lie within the speeds compared."""

POINTS = 200

REST = 0.5
"""rad/s; the arm's own narrow peak of friction lies within, which few samples show."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    parser.add_argument("--port", default="motor", help="where the network acts; this is about learning, not locating")
    parser.add_argument("--units", type=int, default=12)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    data = load_dataset(chosen.case / "dataset.toml")
    found = train_hybrid(
        data,
        load_model("robot_arm"),
        port=chosen.port,
        network={"units": chosen.units},
        settings=TrainingSettings(seed=chosen.seed),
    )
    recorded = np.concatenate([r.signals["motor_speed"] for r in data.estimation()])
    low, high = np.quantile(recorded, [0.5 - VISITED / 2, 0.5 + VISITED / 2])
    speed = np.linspace(low, high, POINTS)
    learned = learned_friction(found, speed)
    key = json.loads((chosen.case / "key.json").read_text())
    effect = concealed_force(key, speed)
    error = learned - (arm_friction(key["truth"], speed) + effect)
    print(
        f"{chosen.case.name}: {'+'.join(key['effects'])}, speeds from {low:.1f} to {high:.1f} rad/s, {found.seconds:.0f} s"
    )
    noise = key["sigma"] ** 2
    print(
        f"mean squared error: physics {found.physics.mse:.5g}, hybrid {found.result.mse:.5g}, noise {noise:.5g} (rad/s)^2"
    )
    beyond = np.abs(speed) > REST
    for where, part in (("all these speeds", beyond | True), (f"beyond {REST:g} rad/s from rest", beyond)):
        mean = np.sqrt(np.mean(error[part] ** 2) / np.mean(effect[part] ** 2))
        largest = np.abs(error[part]).max() / np.abs(effect).max()
        print(
            f"{where}: error of the curve {100 * mean:.1f} % root mean square, {100 * largest:.1f} % of the peak at most"
        )
    return 0


def arm_friction(p: Mapping[str, float], speed: np.ndarray) -> np.ndarray:
    """The friction that the model knows, as a force on the motor, N m."""
    peak = p["F_cs"] / np.cosh(np.clip(p["alpha"] * speed, -80, 80))
    return -p["F_v"] * speed - (p["F_c"] + peak) * np.tanh(p["beta"] * speed)


def learned_friction(found: Trained, speed: np.ndarray) -> np.ndarray:
    """The estimated friction and the network's force, N m."""
    values = found.result.problem.values_by_name
    return arm_friction(values, speed) + found.force(speed=speed)


def concealed_force(key: Mapping, speed: np.ndarray) -> np.ndarray:
    """The force of the case's effects at a speed, N m, by the laws that made the data."""
    total = np.zeros_like(speed)
    for name in key["effects"]:
        effect = CATALOGUE[name]
        switches = {
            k.partition(".")[2]: np.full(len(speed), v) for k, v in key["switches"].items() if k.startswith(name)
        }
        law = effect.law(np.arange(len(speed)), switches, effect.port)
        total += law.force(None, speed)  # type: ignore[attr-defined]
    return total


if __name__ == "__main__":
    raise SystemExit(main())
