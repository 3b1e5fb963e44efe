"""Weights of a model's own modules, such as a network in its equations: no declared parameters, and nothing estimates them."""

from __future__ import annotations

import hashlib
from copy import deepcopy
from typing import Any

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.name_lists import listed


def own_weights(model: GreyBoxModel) -> dict[str, torch.nn.Parameter]:
    """By name, the tensors that the model registered with torch beside its declared parameters."""
    models = [part for part in model.modules() if isinstance(part, GreyBoxModel)]
    declared = {id(one) for part in models for one in part.raw.parameters()}
    return {name: one for name, one in model.named_parameters() if id(one) not in declared}


def with_weights_held(model: GreyBoxModel) -> GreyBoxModel:
    """The model, or a copy whose own weights are constants where they ask torch for gradients: rates and outputs are numbers then."""
    asking = [name for name, one in own_weights(model).items() if one.requires_grad]
    if not asking:
        return model
    made = deepcopy(model)
    for one in own_weights(made).values():
        one.requires_grad_(False)
        one.grad = None
    vars(made)["_asking"] = tuple(asking)
    return made


def let_go(model: GreyBoxModel) -> None:
    """Own weights that :func:`with_weights_held` made constants ask for gradients again, as in the model that was given."""
    for part in [one for one in model.modules() if isinstance(one, GreyBoxModel)]:
        asking = vars(part).pop("_asking", ())
        for name, one in own_weights(part).items():
            if name in asking:
                one.requires_grad_(True)


def told_held(model: GreyBoxModel) -> str:
    """That own weights stay as they are, without a full stop; "" of a model without any."""
    own = own_weights(model)
    if not own:
        return ""
    count = sum(one.numel() for one in own.values())
    owners = list(dict.fromkeys(name.split(".")[0] for name in own))
    return (
        f"The {count} weights of {listed(owners)} in the model stay as they are: only declared parameters are estimated and saved. "
        "`load` needs a model that has these weights"
    )


def digest(model: GreyBoxModel) -> str:
    """SHA-256 of the own weights; "" of a model without any."""
    own = own_weights(model.plain)
    if not own:
        return ""
    found = hashlib.sha256()
    for name, one in own.items():
        found.update(name.encode() + one.detach().cpu().numpy().tobytes())
    return found.hexdigest()


def not_double(model: GreyBoxModel) -> str:
    """Advice to end a message where own weights are not in double precision, as all signals are; "" elsewhere."""
    odd: dict[str, Any] = {n: one for n, one in own_weights(model).items() if one.dtype != torch.float64}
    if not odd:
        return ""
    name, first = next(iter(odd.items()))
    return f"; {name} is {first.dtype}, signals are torch.float64: make it with .double() (self.{name.split('.')[0]} = ….double())"
