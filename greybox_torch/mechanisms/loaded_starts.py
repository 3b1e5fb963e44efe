"""Start states of a model without a kinematic law, taken over by the model with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from greybox_torch.mechanisms import shift
from greybox_torch.model import GreyBoxModel, Signals

if TYPE_CHECKING:
    from greybox_torch.mechanisms.augmented_model import AugmentedModel


def loaded_starts(
    model: AugmentedModel,
    states: np.ndarray,
    known: GreyBoxModel,
    records: Any,
    samples: np.ndarray,
    values: np.ndarray,
) -> np.ndarray:
    """Start states (W, n_x) with the springs behind kinematic laws as far deflected as without these: with the same force.

    A shaft that carries a load lies at one end of its play. Windows that begin in the middle of it leave refits in local minima: the
    larger the play beside the deflections, the more.

    Args:
        states: (W, n_x), those of ``known`` at the windows' first samples, where it has them.
        known: the model without some of the laws.
        samples: (W,), the windows' first samples.
        values: of the declared parameters.
    """
    there = {a.prefix for a in getattr(known, "attachments", ())}
    new = [a for a in model.attachments if a.mechanism.kinematic and a.prefix not in there]
    extends = there <= {a.prefix for a in model.attachments}  # else it takes another's place, which has moved them
    if not new or not extends:
        return states
    result, names = states.copy(), [s.name for s in model.states]
    x, u = model.named_signals(torch.as_tensor(states.T.copy()), torch.as_tensor(records.u[:, samples]))
    declared = [q.name for q in model.declared_parameters]
    p = Signals(
        "parameter", {n: torch.tensor(float(v), dtype=torch.float64) for n, v in zip(declared, values, strict=True)}
    )
    for a in new:
        local, own, _ = model.given(a, x, u, p)
        seen = np.broadcast_to(np.asarray(local.deflection), len(samples))
        moved = a.mechanism.loaded(seen, {n: float(own[n]) for n in own}) - seen
        for name, per_deflection in shift.read(a.shifted_state).items():
            result[:, names.index(name)] += per_deflection * moved
    return result
