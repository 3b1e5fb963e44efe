"""Many arms estimated in one batch, against one at a time: `python -m experiments.fleets.arms --arms 64 --out results/arms`.

Arms of one type with stiffness, damping and friction that scatter by 10 % from machine to machine, each recorded twice (to estimate, to
validate). Inertia and the shape of the friction curve are known; seven parameters and the start speeds of every arm are estimated, from the
same start values. Both ways give complete results: estimates with deviations, what is not determined, and free runs of both experiments
before and after. Writes OUT/arms.json.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch

import greybox_torch as gt
from experiments.speed.settings import header
from greybox_torch.simulation import Pass, Records, Simulator, whole_records
from greybox_torch.systems import RobotArm

SAMPLE_TIME, SUBSTEPS, NOISE = 0.002, 4, 0.02
"""In s; of the plant; of the measured speed, in rad/s."""
ESTIMATED = ("F_v", "F_c", "k_g1", "k_g3", "d_g", "k_a", "d_a")
SCATTER = 0.1
Role = Literal["estimation", "validation"]
ROLES: tuple[Role, ...] = ("estimation", "validation")
UNITS = {"torque": "N m", "motor_speed": "rad/s"}


class Arm(RobotArm):
    """The built-in arm, of which what wears is estimated."""

    parameters = [
        replace(p, fixed=p.name not in ESTIMATED, value=20.0 if p.name == "k_g3" else p.value)
        for p in RobotArm.declared_parameters
    ]


def draw_arms(count: int, samples: int, seed: int) -> list[gt.DataSet]:
    """Recordings of so many arms, all simulated side by side."""
    model, rng = Arm(), np.random.default_rng(seed)
    nominal = np.array(list(model.values().values()))
    ages = np.array([name in ESTIMATED for name in model.values()])
    truth = nominal * np.exp(SCATTER * ages * rng.normal(size=(count, len(nominal))))
    torque = np.array([_torque(rng, samples) for _ in range(count * len(ROLES))])
    first = samples * np.arange(len(torque))
    silent = np.zeros((1, torque.size))
    names = tuple(str(k) for k in range(len(torque)))
    records = Records(torque.reshape(1, -1), silent, silent[0] + SAMPLE_TIME, first, first + samples - 1, names, "zoh")
    asked = Pass(whole_records(records), np.repeat(truth, len(ROLES), axis=0), np.zeros((len(torque), 5)))
    speed = Simulator.of(model).with_substeps(SUBSTEPS).run(records, asked).y[:, :, 0]
    speed = (speed + NOISE * rng.normal(size=speed.shape)).reshape(count, len(ROLES), samples)
    torque = torque.reshape(speed.shape)
    return [
        gt.DataSet([_recording(role, torque[m, e], speed[m, e]) for e, role in enumerate(ROLES)], name=f"Arm {m}")
        for m in range(count)
    ]


def _torque(rng: np.random.Generator, samples: int) -> np.ndarray:
    """Twelve sines from 0.3 to 30 Hz, and a square wave of 5 N m."""
    t, phase = SAMPLE_TIME * np.arange(samples), rng.uniform(0, 2 * np.pi, 13)
    sines = [np.sin(2 * np.pi * f * t + phase[k]) for k, f in enumerate(np.geomspace(0.3, 30.0, 12))]
    return rng.uniform(0.5, 1.5, 12) @ np.array(sines) + 5.0 * np.sign(np.sin(2 * np.pi * 0.4 * t + phase[12]))


def _recording(role: Role, torque: np.ndarray, speed: np.ndarray) -> gt.Recording:
    signals = {"torque": torque, "motor_speed": speed}
    return gt.Recording.from_arrays(role.title(), signals, sample_time=SAMPLE_TIME, role=role, units=UNITS)


def measured(data: list[gt.DataSet], device: str = "cpu") -> dict[str, Any]:
    """Both ways on the same data, and how far their estimates are apart; compiling comes before. The batch is on the device."""
    gt.fit(Arm(), data[0])
    gt.fit_many(Arm(), data[:2], device=device)
    alone, one_by_one = _timed(lambda: [gt.fit(Arm(), each) for each in data])
    together, batch = _timed(lambda: gt.fit_many(Arm(), data, device=device))
    pairs = [(a.parameters[n], b.parameters[n]) for a, b in zip(alone, together, strict=True) for n in ESTIMATED]
    return {
        "arms": len(data),
        "device": torch.cuda.get_device_name(device) if device.startswith("cuda") else "processor",
        "threads": os.environ.get("OMP_NUM_THREADS", "one for each core"),
        "one_by_one": one_by_one,
        "batch": batch,
        "times_the_throughput": one_by_one["seconds"] / batch["seconds"],
        "largest_relative_difference": max(abs(b.value / a.value - 1) for a, b in pairs),
        "of_deviations": max(abs(b.std / a.std - 1) for a, b in pairs),
        "fit_before": float(np.mean([s["fit"] for a in alone for s in a.scores if s["model"] == "start"])),
        "fit_after": float(np.mean([s["fit"] for a in alone for s in a.scores if s["model"] == "refit"])),
    }


def _timed(work: Any) -> tuple[Any, dict[str, float]]:
    wall, processor = time.perf_counter(), time.process_time()
    done = work()
    return done, {"seconds": time.perf_counter() - wall, "processor": time.process_time() - processor}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arms", type=int, default=64)
    parser.add_argument("--samples", type=int, default=4000, help="of each of the two recordings of an arm")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--device", default="cpu", help='of the batch: "cpu" or "cuda"')
    parser.add_argument("--out", type=Path, default=Path("results/arms"))
    chosen = parser.parse_args(arguments)
    found = {"about": header(), "samples": chosen.samples, "seed": chosen.seed}
    found |= measured(draw_arms(chosen.arms, chosen.samples, chosen.seed), chosen.device)
    chosen.out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(found, indent=1)
    (chosen.out / "arms.json").write_text(text)
    print(text, file=sys.stdout)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
