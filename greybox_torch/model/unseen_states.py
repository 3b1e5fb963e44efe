"""States that nothing depends on: the angle of a shaft whose speed alone is measured, kept for effects that may depend on it.

No record says where such a state is. Free in every window of a record it would give an effect that depends on it a phase of its own in
each; so it is carried from window to window.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals import Signals

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel


@once_per_model
def unseen_states(model: GreyBoxModel) -> tuple[str, ...]:
    """Names of the states that no rate and no output of ``model`` depends on, while nothing is attached."""
    x, u, p = random_points(model)
    outputs = {o.name for o in model.outputs}
    with torch.no_grad():
        before = torch.cat([model.rates(x, u, p), model.measured(x, u, p)])
        return tuple(
            state.name
            for i, state in enumerate(model.states)
            if state.name not in outputs and state.initial != "measured" and _same(model, x, u, p, i, before)
        )


def _same(model: GreyBoxModel, x: torch.Tensor, u: torch.Tensor, p: Signals, state: int, before: torch.Tensor) -> bool:
    """Whether rates and outputs stay as they are when one state is moved."""
    moved = x.clone()
    moved[state] += 1.0
    return torch.equal(
        torch.nan_to_num(torch.cat([model.rates(moved, u, p), model.measured(moved, u, p)])), torch.nan_to_num(before)
    )
