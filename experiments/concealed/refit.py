"""How visible an effect is: the plain plant refitted to a case, and the validation error that stays.

    python -m experiments.concealed.refit CASES [NAME ...]

prints, per case, the RMS simulation error [rad/s] of the refitted plain model in the four experiments, and the ratio of that
in validation to the noise of the sensor. A Gauss-Newton fit by finite differences, started at the true parameters: a measure
of the case, not an estimator for users. Also the check of a case without effect: all errors are those of the sensor.
"""

from __future__ import annotations

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.excitation import EXPERIMENTS
from experiments.concealed.plant_arm import PARAMETERS, ArmPlant, Drive

Array = NDArray[np.float64]

FREE = tuple(name for name in PARAMETERS if name not in ("J", "alpha"))
ITERATIONS = 8
STATE_STEPS = np.array([1e-3, 1e-3, 0.05, 0.05, 0.05])
LARGEST_STEPS = np.array([0.1, 0.1, 3.0, 3.0, 3.0])


def simulate(truth: dict[str, Array], states: Array, torque: Array, sample_time: float) -> Array:
    """Motor speed of the plain plant on recorded torque; two integration steps a sample."""
    lanes = states.shape[1]
    plant = ArmPlant(truth, sample_time=sample_time, steps_per_sample=2)
    start = plant.initial_state(states[2:])
    start[:2] = states[:2]
    nothing, zero = np.zeros((len(torque), 1)), np.zeros(lanes)
    return plant.run(start, Drive(torque, nothing, nothing, zero, zero), overflow=True).speed


class Refit:
    """All cases, of one sample time, side by side.

    Torque and speed (samples, cases, 4), parameters {name: (cases,)}, start states (5, cases, 4).
    """

    def __init__(self, folders: list[Path]) -> None:
        self.sample_time: float = tomllib.loads((folders[0] / "dataset.toml").read_text())["sample_time"]
        keys = [json.loads((folder / "key.json").read_text()) for folder in folders]
        tables = [
            [np.loadtxt(folder / f"{name}.csv", delimiter=",", skiprows=1) for name in EXPERIMENTS]
            for folder in folders
        ]
        data = np.array(tables)  # cases, experiments, samples, 2
        self.torque = np.moveaxis(data[..., 0], 2, 0)
        self.speed = np.moveaxis(data[..., 1], 2, 0)
        self.cases = len(folders)
        self.parameters = {name: np.array([key["truth"][name] for key in keys], float) for name in PARAMETERS}
        self.states = np.zeros((5, self.cases, 4))
        self.states[2:] = self.speed[0]

    def columns(self, experiments: slice, samples: int, names: tuple[str, ...]) -> tuple[Array, Array]:
        """Residual (samples, lanes) and its sensitivities to the scaled parameters and the states (samples, columns, lanes)."""
        torque = self.torque[:samples, :, experiments].reshape(samples, -1)
        speed = self.speed[:samples, :, experiments].reshape(samples, -1)
        states = self.states[:, :, experiments].reshape(5, -1)
        lanes, width = states.shape[1], states.shape[1] // self.cases
        copies = 1 + len(names) + 5
        values = {name: np.tile(np.repeat(self.parameters[name], width), copies) for name in PARAMETERS}
        starts = np.tile(states, copies)
        for i, name in enumerate(names):
            values[name][lanes * (1 + i) : lanes * (2 + i)] *= 1.0 + 1e-4
        for i in range(5):
            first = lanes * (1 + len(names) + i)
            starts[i, first : first + lanes] += STATE_STEPS[i]
        simulated = simulate(values, starts, np.tile(torque, copies), self.sample_time).reshape(samples, copies, lanes)
        steps = np.concatenate([np.full(len(names), 1e-4), STATE_STEPS])
        return speed - simulated[:, 0], (simulated[:, 1:] - simulated[:, :1]) / steps[:, None]

    def settle_states(self, experiments: slice, samples: int, rounds: int = 4) -> None:
        """Start states from the first samples."""
        for _ in range(rounds):
            residual, columns = self.columns(experiments, samples, ())
            lanes = range(residual.shape[1])
            step = np.stack([_solve(columns[:, :, i], residual[:, i]) for i in lanes], axis=1)
            step = np.clip(step, -LARGEST_STEPS[:, None], LARGEST_STEPS[:, None])
            self.states[:, :, experiments] += step.reshape(self.states[:, :, experiments].shape)

    def fit(self) -> None:
        """Levenberg-Marquardt on the estimation experiments, all cases in step, each with its own damping."""
        samples = len(self.torque)
        self.settle_states(slice(0, 1), samples // 20)
        damping = np.full(self.cases, 1e-3)
        best = np.full(self.cases, np.inf)
        kept = self._unknowns()
        unknowns = kept.shape[0]
        normal, gradient = np.tile(np.eye(unknowns), (self.cases, 1, 1)), np.zeros((self.cases, unknowns))
        for _ in range(ITERATIONS):
            with np.errstate(over="ignore", invalid="ignore"):  # a trial may overflow: it is rejected
                residual, columns = self.columns(slice(0, 1), samples, FREE)
            residual[~(np.abs(residual) < 1e6)] = np.inf
            loss = (residual**2).mean(axis=0)
            better = loss < best
            damping = np.where(better, damping / 5.0, damping * 10.0)
            best = np.minimum(best, loss)
            kept = np.where(better, self._unknowns(), kept)
            for i in np.nonzero(better)[0]:
                a = columns[:, :, i]
                normal[i], gradient[i] = a.T @ a, a.T @ residual[:, i]
            self._set_unknowns(kept)
            for i in range(self.cases):
                step = np.linalg.solve(normal[i] + damping[i] * np.diag(np.diag(normal[i])), gradient[i])
                for j, name in enumerate(FREE):
                    self.parameters[name][i] *= 1.0 + np.clip(step[j], -0.5, 0.5)
                self.states[:, i, 0] += np.clip(step[len(FREE) :], -LARGEST_STEPS, LARGEST_STEPS)
        self._set_unknowns(kept)

    def _unknowns(self) -> Array:
        """Free parameters and start states of the estimation experiments, (unknowns, cases)."""
        return np.concatenate([np.stack([self.parameters[name] for name in FREE]), self.states[:, :, 0]])

    def _set_unknowns(self, values: Array) -> None:
        for name, row in zip(FREE, values, strict=False):
            self.parameters[name] = row.copy()
        self.states[:, :, 0] = values[len(FREE) :]

    def errors(self) -> Array:
        """RMS error per case and experiment; validation start states from the first tenth."""
        samples = len(self.torque)
        self.settle_states(slice(1, 4), samples // 10)
        width = self.states.shape[2]
        values = {name: np.repeat(self.parameters[name], width) for name in PARAMETERS}
        simulated = simulate(values, self.states.reshape(5, -1), self.torque.reshape(samples, -1), self.sample_time)
        error = self.speed.reshape(samples, -1) - simulated
        return np.sqrt((error**2).mean(axis=0)).reshape(self.cases, width)


def _solve(columns: Array, residual: Array) -> Array:
    if not (np.isfinite(columns).all() and np.isfinite(residual).all()):
        return np.zeros(columns.shape[1])
    return np.asarray(np.linalg.lstsq(columns, residual, rcond=None)[0], np.float64)


def main(arguments: list[str]) -> int:
    if not arguments:
        raise SystemExit(__doc__)
    root = Path(arguments[0])
    folders = [root / name for name in arguments[1:]] or sorted(file.parent for file in root.glob("*/key.json"))
    refit = Refit(folders)
    refit.fit()
    for folder, row in zip(folders, refit.errors(), strict=True):
        key = json.loads((folder / "key.json").read_text())
        ratio = np.sqrt((row[1:] ** 2).mean()) / key["sigma"]
        print(
            f"{folder.name:8s} {'+'.join(key['effects']):28s}",
            *(f"{value:8.3f}" for value in row),
            f"   {ratio:7.1f} sigma",
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
