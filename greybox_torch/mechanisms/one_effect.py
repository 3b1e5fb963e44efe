"""Whether two laws are one effect in a model: whatever the machine does, they add the same to its equations, but for a factor.

An offset of a heater's power and a constant flow of heat into what it heats are the same watts: no recording tells them apart, only what
is known of the machine does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import torch

from greybox_torch.mechanisms.attached import attached
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.lag import Lag
from greybox_torch.mechanisms.linear_law import LinearLaw
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.port_forces import no_forces

POINTS, FEWEST = 256, 16
"""Points at which two laws are compared, and from how many that give numbers something is said."""

DECADES = (-3.0, 4.0)
"""Powers of ten between which states and inputs are drawn, of both signs and, as pressures need it, above zero alone."""

ALIKE, ROUNDING, SEEN = 1e-6, 1e-13, 1e6
"""Relative difference of two contributions that counts as none; what a difference of rates is uncertain by, as a part of the rate; and
how many times that a contribution has to be for the point to count."""


def one_effect(
    one: GreyBoxModel, other: GreyBoxModel, values: Mapping[str, float], others_values: Mapping[str, float]
) -> bool:
    """Whether the law that only ``one`` has, and the law that only ``other`` has, are one effect in the machine's equations.

    So are two laws that are proportional to one parameter each and change all rates and outputs in one proportion, wherever the machine is;
    and a delay before the only input and one behind the only output. Of other laws it is not said: that these recordings do not tell
    them apart may be for want of recordings.

    Args:
        one: a model with effects; ``other`` the same with one of these replaced.
        values: of the parameters of ``one``, by name; ``others_values`` likewise.
    """
    plain, own, around = attached(one)
    _, its, elsewhere = attached(other)
    shared = [a for a in own if a.prefix in {b.prefix for b in its}]
    mine, theirs = _without(own, shared), _without(its, shared)
    if len(mine) != 1 or len(theirs) != 1:
        return False
    first, second = mine[0], theirs[0]
    if second.mechanism.name in twins_in(plain, first.mechanism):
        return True
    if not all(isinstance(a.mechanism, LinearLaw) for a in (first, second)):
        return False
    shifts = [a for a in shared if isinstance(a.mechanism, Lag) or "delayed" in a.mechanism.needs]
    known, held = {**elsewhere, **around}, {**others_values, **values}
    contributions = _contributions(plain, _without(shared, shifts), (first, second), known, held)
    # what a lag or a delay passes on later is the same where it does not change
    return contributions is not None and _in_proportion(*contributions, constant=bool(shifts))


def twins_in(model: GreyBoxModel, law: Mechanism) -> tuple[str, ...]:
    """The laws that no recording of a model's tells from ``law``: those of one input and one output alone."""
    return law.twins if len(model.inputs) == len(model.outputs) == 1 else ()


def _without(attachments: Sequence[Attachment], left_out: Sequence[Attachment]) -> list[Attachment]:
    prefixes = {a.prefix for a in left_out}
    return [a for a in attachments if a.prefix not in prefixes]


def _contributions(
    plain: GreyBoxModel,
    shared: Sequence[Attachment],
    laws: Sequence[Attachment],
    around: Mapping[str, Surroundings],
    values: Mapping[str, float],
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """What each of two laws adds to the rates and outputs of the machine with the ``shared`` effects, and by how much that is uncertain
    from rounding, (n, B) each; None where hardly any point gives numbers.
    """
    models = [AugmentedModel(plain, [*shared, *more], around) for more in ((), laws[:1], laws[1:])]
    states = list(dict.fromkeys(s.name for model in models for s in model.states))
    x = dict(zip(states, _drawn(len(states), 0), strict=True))
    u = dict(zip((s.name for s in plain.inputs), _drawn(len(plain.inputs), 1), strict=True))
    rows = [_rates_and_outputs(model, x, u, values, [s.name for s in models[0].states]) for model in models]
    fine = np.isfinite(np.stack(rows)).all(axis=(0, 1))
    if int(fine.sum()) < FEWEST:
        return None
    without, first, second = (row[:, fine] for row in rows)
    return first - without, second - without, ROUNDING * np.abs(without)


def _drawn(count: int, seed: int) -> torch.Tensor:
    """Values (count, B) over many decades: half of both signs, half above zero."""
    draw = np.random.default_rng(seed)
    sizes = 10.0 ** draw.uniform(*DECADES, size=(count, POINTS))
    signs = np.where(np.arange(POINTS) % 2 == 0, draw.choice([-1.0, 1.0], size=(count, POINTS)), 1.0)
    return torch.as_tensor(sizes * signs, dtype=torch.float64)


def _rates_and_outputs(
    model: GreyBoxModel,
    x: Mapping[str, torch.Tensor],
    u: Mapping[str, torch.Tensor],
    values: Mapping[str, float],
    states: Sequence[str],
) -> np.ndarray:
    """The rates of ``states`` and the outputs of a model, (n, B)."""
    own = Signals("state", {s.name: x[s.name] for s in model.states})
    inputs, forces = Signals("input", dict(u)), no_forces(model)
    p = Signals(
        "parameter",
        {q.name: torch.tensor(values.get(q.name, q.value), dtype=torch.float64) for q in model.declared_parameters},
    )
    with torch.no_grad():
        rates, outputs = model.derivative(own, inputs, p, forces), model.outputs_with(own, inputs, p, forces)
    given = [*(rates[name] for name in states), *(outputs[o.name] for o in model.outputs)]
    return np.stack([torch.as_tensor(row, dtype=torch.float64).expand(POINTS).numpy() for row in given])


def _in_proportion(first: np.ndarray, second: np.ndarray, unsure: np.ndarray, *, constant: bool) -> bool:
    """Whether two contributions (n, B) differ by a factor alone; with ``constant``, whether they are the same everywhere as well.

    Where rates are so large that rounding hides a contribution, nothing is compared.
    """
    seen = (np.maximum(np.abs(first), np.abs(second)) > SEEN * unsure).any(axis=0)
    if int(seen.sum()) < FEWEST:
        return False
    first, second, unsure = (row[:, seen] for row in (first, second, unsure))
    strongest = int(np.argmax(np.abs(second).sum(axis=0)))
    at = second[:, strongest]
    factor = float(first[:, strongest] @ at / (at @ at)) if at.any() else 0.0
    if factor == 0.0:
        return False
    scaled = factor * second
    if (np.abs(first - scaled) > ALIKE * (np.abs(first) + np.abs(scaled)) + unsure).any():
        return False
    return not constant or bool((np.ptp(first, axis=1) <= ALIKE * np.abs(first).max(axis=1) + unsure.max(axis=1)).all())
