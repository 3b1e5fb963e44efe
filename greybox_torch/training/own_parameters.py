"""What changes of the model's own parameters do as a force at the port of a network: what a network may have learned in their place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.linear_algebra import least_squares
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.signals import parameter_signals
from greybox_torch.training.learned_force import MOST_SAMPLES, visited
from greybox_torch.training.trained import Trained

STEP = 1e-6
"""Relative step of the differences that slopes are taken by."""

ELSEWHERE = 1e-6
"""Share of what a parameter changes, squared, of any rate or output, that a force at the port may not do."""

SCATTER = 0.02
"""Share of a force's variance up to which it may differ between neighbours in the network's signals, and be a function of these."""

STILL = 1e-9
"""Part of a signal's size below which what it moves is rounding."""

INDEPENDENT = 1e-6
"""Singular values below this share of the largest are taken for zero: parameters that the samples visited do not tell apart."""


@dataclass(frozen=True)
class OwnParameters:
    """The free parameters ``names`` (k,) of the model that act as a force at the port does that is a function of the network's signals,
    with their ``values`` and bounds (k,), and the ``force`` (N, k) there that a unit of each stands for at the samples visited.
    """

    names: tuple[str, ...]
    values: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    force: np.ndarray

    def taking_over(self, force: np.ndarray) -> dict[str, float]:
        """The values with which the parameters do what comes nearest to a force (N,), as far as their bounds allow."""
        if not self.names:
            return {}
        scale = np.maximum(np.linalg.norm(self.force, axis=0), 1e-300)
        moved = least_squares(self.force / scale, force, rcond=INDEPENDENT) / scale
        return dict(zip(self.names, map(float, np.clip(self.values + moved, self.lower, self.upper)), strict=True))


def own_parameters(found: Trained, signals: Mapping[str, np.ndarray]) -> OwnParameters:
    """The parameters of the physics that are free beside the network, and in whose place it can learn something: they change rates and
    outputs as a force at its port does that is a function of its ``signals`` (N,).

    One that acts elsewhere as well is left out, as no force at the port stands for it; and one that acts by other signals. Seen: an inertia
    and a friction beside a network that reads the voltage come, with an input that does nothing, to nothing, and explain any curve.
    """
    problem, physics = found.result.problem, found.physics.problem.names
    changes = _Changes(found)
    per_force = changes.between({changes.unit: 0.0}, {changes.unit: 1.0})
    strength = np.maximum((per_force**2).sum(axis=0), 1e-300)
    places, forces = [], []
    for k in np.flatnonzero(problem.free):
        name, value = problem.names[k], float(problem.values[k])
        if name not in physics:
            continue
        step = STEP * (abs(value) or abs(float(problem.expected[k])) or 1.0)
        ends = (max(value - step, float(problem.lower[k])), min(value + step, float(problem.upper[k])))
        slope = changes.between({name: ends[0]}, {name: ends[1]}) / max(ends[1] - ends[0], 1e-300)
        force = (per_force * slope).sum(axis=0) / strength
        beside = ((slope - per_force * force) ** 2).sum(axis=1)
        if (
            np.isfinite(force).all()
            and force.any()
            and _is_function(force, signals)
            and (beside <= ELSEWHERE * (slope**2).sum(axis=1)).all()
        ):
            places, forces = [*places, int(k)], [*forces, force]
    columns = np.array(forces).reshape(len(places), per_force.shape[1]).T
    names = tuple(problem.names[k] for k in places)
    return OwnParameters(names, problem.values[places], problem.lower[places], problem.upper[places], columns)


def _is_function(force: np.ndarray, signals: Mapping[str, np.ndarray]) -> bool:
    """Whether a force (N,) hardly differs between samples that are neighbours in the signals (N,), beside what it differs by in all."""
    # A tenth of a second to import, which only a network that has learned something needs.
    from scipy.spatial import KDTree

    moving = [v / np.std(v) for v in signals.values() if np.std(v) > STILL * max(float(np.abs(v).max()), 1e-300)]
    if not moving or len(force) < 2:
        return bool(np.ptp(force) == 0.0)
    places = np.stack(moving, axis=1)
    nearest = np.asarray(KDTree(places).query(places, k=2)[1])[:, 1]
    return float(np.mean((force - force[nearest]) ** 2)) <= 2.0 * SCATTER * float(np.var(force))


class _Changes:
    """Rates and outputs of a hybrid with one force more at the port of its network, where its free run takes it."""

    def __init__(self, found: Trained) -> None:
        model, network = found.result.problem.model, found.hybrid.network
        assert isinstance(model, AugmentedModel)
        more = attach(model, network.port, ResidualNet(network.mechanism.needs, 1), label="_more")
        self.unit = f"{more.prefix}.offset"
        self.model: GreyBoxModel = AugmentedModel(model.base, (*model.attachments, more), model.surroundings)
        self.values = {p.name: p.value for p in self.model.declared_parameters} | found.result.problem.values_by_name
        self.states, self.inputs = visited(found, most=MOST_SAMPLES)

    def between(self, first: Mapping[str, float], second: Mapping[str, float]) -> np.ndarray:
        """By how much they are more (n_x + n_y, N) with parameters as ``second`` has them than as ``first`` does."""
        return self._at(second) - self._at(first)

    def _at(self, values: Mapping[str, float]) -> np.ndarray:
        p = parameter_signals({**self.values, **values})
        with torch.no_grad(), np.errstate(all="ignore"):
            shown = (self.model.rates, self.model.measured)
            return torch.cat([one(self.states, self.inputs, p) for one in shown]).numpy()
