"""The task of the network row: windows of the arm's record, and a friction network on the motor speed.

The network's torque (N m) adds to the motor's friction and is ``output @ tanh(hidden * speed / SPEED_SCALE + hidden_bias) + output_bias``
with 16 hidden units. All numbers are plain NumPy, so that each rival builds what it likes from them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from experiments.speed.records import SAMPLES, arm_values, simulated_records
from greybox_torch.simulation import Pass, Records, Simulator, Windows, whole_records
from greybox_torch.systems import RobotArm

WIDTH = 16
SPEED_SCALE = 20.0
"""rad/s."""


@dataclass(frozen=True)
class NetworkTask:
    """W windows of K samples of records with one record: start states ``x0`` (W, 5), arm parameters ``p`` (13,), and the weights
    ``hidden`` (16,), ``hidden_bias`` (16,), ``output`` (16,), ``output_bias`` (1,).

    The loss is the mean over windows and samples of (simulated − measured motor speed)², in (rad/s)². Its gradient is given in the order
    hidden, hidden_bias, output, output_bias: (49,).
    """

    records: Records
    windows: Windows
    x0: np.ndarray
    p: np.ndarray
    hidden: np.ndarray
    hidden_bias: np.ndarray
    output: np.ndarray
    output_bias: np.ndarray

    @property
    def index(self) -> np.ndarray:
        """Samples (W, K) of the records that the windows cover."""
        return self.windows.start[:, None] + np.arange(self.windows.steps)


def network_task(windows: int = 64, length: int = 200, *, seed: int = 3) -> NetworkTask:
    """Windows spread evenly over a simulated record, beginning at its true states, and small random weights."""
    records = simulated_records(1, max(SAMPLES, windows * length))
    whole = Simulator.of(RobotArm(), ()).run(
        records,
        Pass(whole_records(records), arm_values(), np.array([[0.0, 0.0, -19.0, -22.3, -23.3]]), keep_states=True),
    )
    assert whole.states is not None
    start = np.linspace(0, records.u.shape[1] - length, windows).astype(np.int64)
    rng = np.random.default_rng(seed)
    return NetworkTask(
        records=records,
        windows=Windows(start, start + length - 1, length),
        x0=np.array(whole.states[0, start]),
        p=arm_values(),
        hidden=rng.normal(0.0, 1.0, WIDTH),
        hidden_bias=rng.normal(0.0, 0.5, WIDTH),
        output=rng.normal(0.0, 0.1, WIDTH),
        output_bias=rng.normal(0.0, 0.1, 1),
    )
