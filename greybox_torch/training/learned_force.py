"""What a network has learned: its force where the machine was, over each of its signals, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.estimate.free_run import FreeRun, visited_states
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.uncertainty import uncertainty
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.network import spoken
from greybox_torch.model import Signals
from greybox_torch.training.polish import PenalisedRun
from greybox_torch.training.trained import Trained

MOST_SAMPLES = 4000
BINS = 40

NARROW = 0.25
"""Share of the curve's height up to which a band around zero says that it is zero."""


@dataclass(frozen=True)
class LearnedForce:
    """The force (N,) of a network at local ``signals`` (N,) along the free run of the estimation experiments.

    ``slope`` (N, d) is its derivative by the network's free parameters, ``covariance`` (d, d) theirs, by two ways of reckoning: with
    residuals taken as white, and with coloured ones. The penalty counts as knowledge.
    """

    signals: Mapping[str, np.ndarray]
    force: np.ndarray
    slope: np.ndarray
    covariances: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class SignalCurve:
    """The mean force (K,) over one signal (K,), one standard deviation of it (K,), and the share of the force's variance that this curve
    alone explains (the correlation ratio: shares of several signals need not add up to one).

    Source: K. Pearson, "On the general theory of skew correlation and non-linear regression", 1905.
    """

    signal: str
    unit: str
    values: np.ndarray
    force: np.ndarray
    deviation: np.ndarray
    share: float
    name: str = ""
    """The signal as the model calls it, where it has a name there."""

    @property
    def told(self) -> str:
        """The signal as it is told."""
        return self.name or spoken(self.signal)

    @property
    def zero_within(self) -> float:
        """Share of what was visited over which the band of two deviations contains zero, and is not as narrow as to say that it is zero."""
        band = 2.0 * self.deviation
        wide = band > NARROW * np.max(np.abs(self.force))
        return float(np.mean(wide & (np.abs(self.force) <= band)))


def learned_force(found: Trained) -> LearnedForce:
    """The network's force where the free run of the hybrid takes it, at no more than :data:`MOST_SAMPLES` samples."""
    signals = visited_signals(found, most=MOST_SAMPLES)
    force, slope = force_at(found, signals)
    return LearnedForce(signals, force, slope, _covariances(found))


def visited_signals(found: Trained, elsewhere: Problem | None = None, most: int | None = None) -> dict[str, np.ndarray]:
    """What the network reads (N,) along the free run of the estimation experiments.

    Args:
        elsewhere: other experiments of the hybrid, from their start states.
        most: samples, spread evenly; by default all.
    """
    problem = found.result.problem if elsewhere is None else elsewhere
    model = problem.model
    assert isinstance(model, AugmentedModel)
    states, inputs = visited(found, elsewhere, most)
    x, u = model.named_signals(states, inputs)
    local = model.local_signals(found.hybrid.network, x, u, problem.parameter_tensors)
    needs = found.hybrid.network.mechanism.needs
    return {n: np.broadcast_to(np.asarray(local[n], dtype=float), states.shape[1:]) for n in needs}


def visited(
    found: Trained, elsewhere: Problem | None = None, most: int | None = None
) -> tuple[torch.Tensor, torch.Tensor]:
    """States (n_x, N) and inputs (n_u, N) along that free run; arguments as for :func:`visited_signals`."""
    problem, simulator = found.result.problem, found.course.simulator
    if elsewhere is not None:
        problem, simulator = elsewhere, simulator.with_substeps(found.result.substeps)
    records = problem.driving_records
    states = np.concatenate(visited_states(problem, simulator))
    spans = [records.span(e) for e in range(len(records.lengths))]
    index = np.concatenate([np.arange(span.start, span.stop) for span in spans])
    kept = slice(None, None, 1 if most is None else max(1, -(-len(index) // most)))
    return torch.as_tensor(states[kept].T), torch.as_tensor(records.u[:, index[kept]])


def force_at(found: Trained, signals: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The network's force (N,) at local signals (N,), and its derivative (N, d) by its free parameters."""
    model, network = found.result.problem.model, found.hybrid.network
    assert isinstance(model, AugmentedModel)
    local = {name: torch.tensor(np.ascontiguousarray(value)) for name, value in signals.items()}
    values, names = dict(found.result.problem.parameter_tensors), _network_names(found)

    def force(own: torch.Tensor) -> torch.Tensor:
        p = Signals("parameter", {**values, **dict(zip(names, own.unbind(), strict=True))})
        return torch.broadcast_to(model.curve(network, local, p), next(iter(local.values())).shape)

    own = torch.stack([values[name] for name in names])
    return force(own).numpy(), torch.func.jacfwd(force)(own).numpy()


def curves_of(forces: Sequence[LearnedForce], units: Mapping[str, str]) -> tuple[SignalCurve, ...]:
    """The mean force over each signal, with the deviation that the parameters' covariance gives; of several networks at the same signals
    their mean, with what they differ among themselves added to the variance.

    Source: B. Lakshminarayanan et al., "Simple and scalable predictive uncertainty estimation using deep ensembles", 2017 (the mixture).
    """
    first = forces[0]
    return tuple(_curve(name, units.get(name, ""), values, forces) for name, values in first.signals.items())


def _curve(name: str, unit: str, values: np.ndarray, forces: Sequence[LearnedForce]) -> SignalCurve:
    bins = [b for b in np.array_split(np.argsort(values, kind="stable"), min(BINS, len(values))) if len(b)]
    means = np.array([[f.force[b].mean() for b in bins] for f in forces])
    within = np.array([_variance(f, bins) for f in forces])
    between = means.var(axis=0, ddof=1) if len(forces) > 1 else 0.0
    force = np.mean([f.force for f in forces], axis=0)
    curve, sizes = means.mean(axis=0), np.array([len(b) for b in bins])
    explained, total = float((sizes * (curve - force.mean()) ** 2).sum()), float(((force - force.mean()) ** 2).sum())
    return SignalCurve(
        name,
        unit,
        np.array([values[b].mean() for b in bins]),
        curve,
        np.sqrt(within.mean(axis=0) + between),
        explained / total if total > 0 else 0.0,
    )


def _variance(force: LearnedForce, bins: Sequence[np.ndarray]) -> np.ndarray:
    """Variance (K,) of the mean force in every bin: the larger of the two ways to reckon."""
    slopes = np.stack([force.slope[b].mean(axis=0) for b in bins])
    return np.max([np.einsum("kd,de,ke->k", slopes, c, slopes) for c in force.covariances], axis=0)


def _covariances(found: Trained) -> tuple[np.ndarray, ...]:
    """Of the network's free parameters (d, d), beside everything else that was estimated."""
    run = FreeRun(found.result.problem, found.course.simulator)
    weight = (found.polished.chosen.weight or 0.0) * found.course.mean_square
    penalty = PenalisedRun(run, found.course.unknowns, weight).stiffness
    whole = uncertainty(run, run.start, penalty)
    own = np.flatnonzero(np.isin(found.result.problem.free_names, _network_names(found)))
    return tuple(covariance[np.ix_(own, own)] for covariance in (whole.plain, whole.sandwich))


def _network_names(found: Trained) -> list[str]:
    start = f"{found.hybrid.network.prefix}."
    return [name for name in found.result.problem.free_names if name.startswith(start)]
