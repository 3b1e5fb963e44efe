"""The generalised force that is missing at a port, over time, if all that the model leaves of the measured motion enters there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.equation_error import EquationError
from greybox_torch.model.ports import Actuator


@dataclass(frozen=True)
class MissingForce:
    """A force (M,) in the port's unit, averaged over the shortest stretches on which it stands above the sensors' noise.

    With the ``signals`` (M,) at the port by name (speed, position, …), in the middle of the stretches, ``time`` (M,) in s since the start
    of its ``experiment`` (M,), by index.
    """

    port: str
    force: np.ndarray
    signals: Mapping[str, np.ndarray]
    time: np.ndarray
    experiment: np.ndarray


def missing_force(view: EquationError, port: str) -> MissingForce:
    """The force at ``port`` that would make the model's equations agree best with the measured motion, at a view's parameters.

    Where several equations have it, least squares weighed by what they leave.
    """
    equations, finest = view.equations, view.finest
    model = equations.problem.model
    site = next(p for p in model.all_ports if p.name == port)
    left, _ = equations.linearised(equations.start, inverse=False)
    if isinstance(site, Actuator):
        slopes = equations.input_slopes[:, [i.name for i in model.inputs].index(site.input)]
    else:
        slopes = equations.force_slopes(port)
    weights = 1.0 / np.maximum(np.mean(finest.mean(left) ** 2, axis=1, keepdims=True), 1e-300)
    strength = np.maximum((weights * slopes**2).sum(axis=0), 1e-300)
    force = (weights * slopes * left).sum(axis=0) / strength
    signals = {n: v[finest.middle] for n, v in equations.signals(site).items()}
    return MissingForce(port, finest.mean(force), signals, equations.motion.time[finest.middle], finest.experiment)
