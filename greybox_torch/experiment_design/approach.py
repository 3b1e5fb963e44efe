"""How a command begins: a set point where its output stands, an input of a limited rate where it stood, and from there to what is asked."""

from __future__ import annotations

import numpy as np

from greybox_torch.experiment_design.as_recorded import continued
from greybox_torch.experiment_design.contender import Contender
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.experiment_design.simulated import input_records

ACROSS = 0.1
"""Share of the recording in which a set point may cross its range at the beginning, where no rate is given or a faster one."""


def begun_at(one: Contender, limits: Limits, step: float) -> dict[str, float]:
    """Where commands begin, by input: set points where the outputs that follow them stand; inputs whose rate is limited where these stood
    as the recording began that a next one begins like, within their range.

    Args:
        step: the sample time, s.
    """
    names, ranges = [i.name for i in one.problem.model.inputs], limits.commanded
    records, found = one.problem.records, {}
    for name, own in ranges.items():
        if np.isfinite(own.rate) and name not in (*limits.set_points, *limits.kept):
            found[name] = float(records.u[names.index(name), records.first[one.begins]])
    if one.loops:
        inputs = np.array([[limits.kept[n][0] if n in limits.kept else own.middle] for n, own in limits.inputs.items()])
        for loop in one.loops:
            inputs[loop.driven] = loop.rest
        at_rest = input_records(one, [np.repeat(inputs, 2, axis=1)], step * np.arange(2))
        y = one.predicted(at_rest, tangents=False).y[0, 0]
        found |= {names[loop.driven]: float(y[loop.measured]) for loop in one.loops}
    return {name: float(np.clip(value, ranges[name].lower, ranges[name].upper)) for name, value in found.items()}


def begun_there(commands: np.ndarray, time: np.ndarray, limits: Limits) -> np.ndarray:
    """Commands (n_u, N) at times (N,) in s that begin as ``limits.begin`` has it, and run to what was commanded at a steady rate; inputs
    that are kept as recorded are that.

    Begun elsewhere, a controller would command its limit at the first sample, and an input would step beyond its rate.
    """
    found = commands.copy()
    step, span = float(time[1] - time[0]), float(time[-1] - time[0])
    for k, (name, own) in enumerate(limits.commanded.items()):
        if name in limits.kept:
            found[k] = continued(limits.kept[name], len(time))
        elif name in limits.begin:
            across = 2.0 * own.half / (ACROSS * span)
            rate = min(own.rate, across) if name in limits.set_points else own.rate
            found[k] = _approached(commands[k], limits.begin[name], rate * step)
    return found


def _approached(values: np.ndarray, start: float, most: float) -> np.ndarray:
    """``values`` (N,) from where a ramp from ``start`` that changes by ``most`` a sample meets them."""
    side = np.sign(values[0] - start)
    ramp = start + side * most * np.arange(len(values))
    behind = side * (values - ramp) > 0.0
    met = len(values) if behind.all() else int(np.argmin(behind))
    return np.concatenate([ramp[:met], values[met:]])
