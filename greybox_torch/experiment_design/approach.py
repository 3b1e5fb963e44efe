"""How a set point begins: where its output stands, and from there to what is asked for."""

from __future__ import annotations

import numpy as np

from greybox_torch.experiment_design.limits import Limits

ACROSS = 0.1
"""Share of the recording in which a set point may cross its range at the beginning, where no rate is given or a faster one."""


def begun_there(commands: np.ndarray, time: np.ndarray, limits: Limits) -> np.ndarray:
    """Commands (n_u, N) at times (N,) in s whose set points begin where the outputs do, and run to what was commanded at a steady rate.

    Begun elsewhere, a controller would command its limit at the first sample.
    """
    found = commands.copy()
    step, span = float(time[1] - time[0]), float(time[-1] - time[0])
    for k, (name, own) in enumerate(limits.commanded.items()):
        if name in limits.begin:
            rate = min(own.rate, 2.0 * own.half / (ACROSS * span))
            found[k] = _approached(commands[k], float(np.clip(limits.begin[name], own.lower, own.upper)), rate * step)
    return found


def _approached(values: np.ndarray, start: float, most: float) -> np.ndarray:
    """``values`` (N,) from where a ramp from ``start`` that changes by ``most`` a sample meets them."""
    side = np.sign(values[0] - start)
    ramp = start + side * most * np.arange(len(values))
    behind = side * (values - ramp) > 0.0
    met = len(values) if behind.all() else int(np.argmin(behind))
    return np.concatenate([ramp[:met], values[met:]])
