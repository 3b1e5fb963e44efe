"""What changes of the model's own parameters do as a force at the port of a network: what a network may have learned in their place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.rates_and_outputs import RatesAndOutputs
from greybox_torch.linear_algebra import least_squares
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.training.learned_force import MOST_SAMPLES, visited
from greybox_torch.training.trained import Trained

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
    changes, unit = _hybrid_with_one_more(found)
    per_force = changes.between({unit: 0.0}, {unit: 1.0})
    strength = np.maximum((per_force**2).sum(axis=0), 1e-300)
    places, forces = [], []
    for k in np.flatnonzero(problem.free):
        name = problem.names[k]
        if name not in physics:
            continue
        slope = changes.slope(name, (float(problem.lower[k]), float(problem.upper[k])), float(problem.expected[k]))
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


def _hybrid_with_one_more(found: Trained) -> tuple[RatesAndOutputs, str]:
    """Rates and outputs of a hybrid with one force more at the port of its network, where its free run takes it, and that force's name."""
    model, network = found.result.problem.model, found.hybrid.network
    assert isinstance(model, AugmentedModel)
    more = attach(model, network.port, ResidualNet(network.mechanism.needs, 1), label="_more")
    with_it = AugmentedModel(model.base, (*model.attachments, more), model.surroundings)
    values = {p.name: p.value for p in with_it.declared_parameters} | found.result.problem.values_by_name
    return RatesAndOutputs(with_it, values, *visited(found, most=MOST_SAMPLES)), f"{more.prefix}.offset"
