"""One experiment of a machine in MuJoCo, under feedback of what its sensors show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SPEED_FILTER = 0.3  # share of the newest difference in the controller's estimate of a speed


@dataclass(frozen=True)
class Feedback:
    """What the cabinet does: per input its feedforward and reference (samples, inputs), the output that it follows, its gains by position
    and speed (inputs,)."""

    feedforward: Array
    reference: Array
    followed: tuple[int, ...]
    gain: Array
    speed_gain: Array


@dataclass(frozen=True)
class Sensing:
    """Rows of the state (positions, then speeds) that are shown, their noise and jitter [s] (samples, outputs), steps of the read-out."""

    rows: tuple[int, ...]
    noise: Array
    jitter: Array
    resolution: Array


@dataclass(frozen=True)
class Experiment:
    """command (samples, inputs), outputs (samples, outputs), states (samples, 2 x joints): positions, then speeds."""

    command: Array
    outputs: Array
    states: Array


def run(
    xml: str,
    feedback: Feedback,
    sensing: Sensing,
    *,
    disturbance: Array,
    start: Array,
    sample_time: float,
    delay: float = 0.0,
) -> Experiment:
    """Simulate from the positions `start`, at rest. `disturbance` (samples,) acts at the first joint; commands act `delay` s late.

    From where the simulation is lost (MuJoCo starts anew there) everything is NaN. Raises ImportError where mujoco is not installed.
    """
    import mujoco

    mujoco.set_mju_user_warning(_not_to_a_file)
    lost = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
    model = mujoco.MjModel.from_xml_string(xml)
    data: Any = mujoco.MjData(model)
    data.qpos[:] = start
    samples, steps = len(feedback.feedforward), round(sample_time / model.opt.timestep)
    whole, rest = divmod(round(delay / model.opt.timestep), steps)
    command = np.empty_like(feedback.feedforward)
    outputs, states = np.empty((samples, len(sensing.rows))), np.empty((samples, 2 * model.nv))
    slope, before = np.zeros(len(feedback.followed)), None
    for k in range(samples):
        mujoco.mj_forward(model, data)  # rates at this instant, for the samples taken off their time
        states[k] = np.concatenate([data.qpos, data.qvel])
        rates = np.concatenate([data.qvel, data.qacc])[list(sensing.rows)]
        outputs[k] = _read(
            states[k][list(sensing.rows)] + sensing.jitter[k] * rates + sensing.noise[k], sensing.resolution
        )
        seen = outputs[k][list(feedback.followed)]
        before = seen if before is None else before
        slope += SPEED_FILTER * ((seen - before) / sample_time - slope)
        wanted = (feedback.reference[k] - feedback.reference[max(k - 1, 0)]) / sample_time
        command[k] = feedback.feedforward[k] + feedback.gain * (feedback.reference[k] - seen)
        command[k] += feedback.speed_gain * (wanted - slope)
        before = seen
        data.qfrc_applied[0] = disturbance[k]
        for late, count in ((whole + 1, rest), (whole, steps - rest)):
            if count:
                data.ctrl[:] = command[max(k - late, 0)]
                mujoco.mj_step(model, data, nstep=count)
        if any(data.warning[kind].number for kind in lost):
            outputs[k:], command[k:], states[k:] = np.nan, np.nan, np.nan
            break
    return Experiment(command, outputs, states)


def _not_to_a_file(text: str) -> None:
    """MuJoCo's warnings: a run that is lost is NaN, which says it; the log file in the working folder is not wanted."""


def _read(shown: Array, resolution: Array) -> Array:
    fine = np.where(resolution > 0.0, resolution, 1.0)
    return np.where(resolution > 0.0, fine * np.round(shown / fine), shown)
