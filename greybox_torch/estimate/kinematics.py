"""Start values of states that no sensor shows but whose integral one does: the speed behind a measured position.

A start value of zero for such a speed leaves a window far from the measured motion, at times in another valley of its error. Where the
rates of measured states are a fixed linear function of the states (a position's rate is its speed, a spring's is the difference of two),
that function and the measured signal's own slope give the others at once.

Source: local polynomial slope, A. Savitzky and M. J. E. Golay, Analytical Chemistry 36(8), 1964.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.linear_algebra import least_squares, pseudo_inverse, solve
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.model.signals import parameter_signals
from greybox_torch.simulation.records import Records

TRIALS = 6
"""Random points per unknown coefficient at which a rate is looked at."""

EXACT = 1e-9
"""Relative deviation up to which a rate is a linear function."""

HALF_WIDTHS = (2, 40)
"""Fewest and most samples on either side from which a slope is taken."""

FEWEST = 4
"""Known samples that a slope needs."""

SHARE_OF_WINDOW = 8
"""Part of a window that one side of the slope's stretch is."""


@dataclass(frozen=True)
class Kinematics:
    """Rates of measured states that are linear in states and inputs, whatever the parameters.

    ``outputs`` (K,) indices of the outputs that measure them; ``measured`` and ``hidden`` indices of the model's states with and without
    a sensor of their own; ``known`` (K, n_measured), ``inputs`` (K, n_u), ``constant`` (K,) and ``inverse`` (n_hidden, K): the hidden
    states are ``inverse`` (slopes − known x − inputs u − constant), those marked in ``determined`` (n_hidden,) uniquely.
    """

    outputs: np.ndarray
    measured: np.ndarray
    hidden: np.ndarray
    known: np.ndarray
    inputs: np.ndarray
    constant: np.ndarray
    inverse: np.ndarray
    determined: np.ndarray


def hidden_starts(
    model: GreyBoxModel, records: Records, states: np.ndarray, samples: np.ndarray, steps: int
) -> np.ndarray:
    """``states`` (W, n_x) at ``samples`` (W,), hidden states that kinematics determine filled in.

    Args:
        states: with the measured states at their measured values.
        steps: length of the windows that begin there, in samples: a slope is taken over a part of it.
    """
    relations = kinematics_of(model)
    if relations is None:
        return states
    half = int(np.clip(steps // SHARE_OF_WINDOW, *HALF_WIDTHS))
    slopes = np.stack([_slopes(records, k, samples, half) for k in relations.outputs], axis=1)
    own = relations.inputs[
        :, : len(records.u)
    ]  # effects may add inputs of their own, which no position's rate depends on
    rest = slopes - states[:, relations.measured] @ relations.known.T - records.u[:, samples].T @ own.T
    found = (rest - relations.constant) @ relations.inverse.T
    filled = states.copy()
    usable = relations.determined & np.isfinite(found)
    filled[:, relations.hidden] = np.where(usable, found, filled[:, relations.hidden])
    return filled


@once_per_model
def kinematics_of(model: GreyBoxModel) -> Kinematics | None:
    """The kinematic relations of a model; None where there are none."""
    outputs, sensed = [o.name for o in model.outputs], sensed_states(model)
    own = np.array([s.name in sensed or s.initial == "measured" for s in model.states])
    shown = [(i, outputs.index(sensed[s.name])) for i, s in enumerate(model.states) if s.name in sensed]
    hidden, measured = np.flatnonzero(~own), np.flatnonzero(own)
    if not shown or not len(hidden):
        return None
    signals, rates = _at_random(model)
    if rates is None:
        return None
    rows = []
    for i, output in shown:
        found = least_squares(signals, rates[i])
        exact = np.abs(signals @ found - rates[i]).max() <= EXACT * max(float(np.abs(rates[i]).max()), 1e-300)
        found = np.where(np.abs(found) > EXACT, found, 0.0)
        if exact and found[hidden].any():
            rows.append((output, found))
    if not rows:
        return None
    table, n_x = np.array([found for _, found in rows]), len(model.states)
    inverse = pseudo_inverse(table[:, hidden], rcond=1e-8)
    determined = np.abs(inverse @ table[:, hidden] - np.eye(len(hidden))).max(axis=1) < 1e-6
    return Kinematics(
        outputs=np.array([output for output, _ in rows]),
        measured=measured,
        hidden=hidden,
        known=table[:, measured],
        inputs=table[:, n_x:-1],
        constant=table[:, -1],
        inverse=inverse,
        determined=determined,
    )


def _at_random(model: GreyBoxModel) -> tuple[np.ndarray, np.ndarray | None]:
    """States, inputs and one (M, n_x + n_u + 1) drawn at random, and the rates (n_x, M) there; None where these are not finite."""
    n_x, n_u = len(model.states), len(model.inputs)
    rng = np.random.default_rng(0)
    count = TRIALS * (n_x + n_u + 1)
    drawn = rng.standard_normal((n_x + n_u, count))
    values = {q.name: q.value * (1 + 0.1 * rng.uniform(-1, 1, count)) for q in model.declared_parameters}
    p = parameter_signals(values)
    with torch.no_grad():
        rates = model.rates(torch.as_tensor(drawn[:n_x]), torch.as_tensor(drawn[n_x:]), p).numpy()
    finite = np.isfinite(rates).all(axis=0)
    if finite.sum() < 2 * (n_x + n_u + 1):
        return drawn.T, None
    return np.hstack([drawn.T, np.ones((count, 1))])[finite], rates[:, finite]


def _slopes(records: Records, output: int, samples: np.ndarray, half: int) -> np.ndarray:
    """The slopes (W,) of a measured signal at ``samples`` (W,), from parabolas through those around; NaN where too few are known."""
    experiment = records.experiments(samples)
    near = samples[:, None] + np.arange(-half, half + 1)
    inside = (near >= records.first[experiment][:, None]) & (near <= records.last[experiment][:, None])
    near = np.clip(near, 0, records.y.shape[1] - 1)
    y, clock = records.y[output, near], np.concatenate([[0.0], np.cumsum(records.dt[:-1])])
    weight = (inside & ~np.isnan(y)).astype(float)
    time = clock[near] - clock[samples][:, None]
    reach = np.abs(time * weight).max(axis=1)
    scale = np.where(reach > 0, reach, 1.0)
    powers = (time / scale[:, None])[..., None] ** np.arange(3)
    normal = np.einsum("wsi,wsj,ws->wij", powers, powers, weight)
    right = np.einsum("wsi,ws->wi", powers, np.where(weight > 0, y, 0.0))
    known = weight.sum(axis=1) >= FEWEST
    normal[~known] = np.eye(3)
    found = solve(normal, right[..., None])[:, 1, 0] / scale
    return np.where(known, found, np.nan)
