"""Which inputs of a model a controller drives, and what it follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from greybox_torch.data.card_controller import LoopEntry
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.model import GreyBoxModel


def check_controller(loops: Mapping[str, LoopEntry], model: GreyBoxModel, place: str) -> None:
    """Whether every loop drives an input of a model by one of its outputs.

    Args:
        place: how a message begins.

    Raises:
        UserError: naming the entry, what was found, and what the model has.
    """
    inputs, outputs = [i.name for i in model.inputs], [o.name for o in model.outputs]
    for name, loop in loops.items():
        _check(name, inputs, "input", f"{place} {name}", model)
        _check(loop.measured, outputs, "output", f"{place} {name}, measured", model)


def _check(name: str, known: Sequence[str], kind: str, place: str, model: GreyBoxModel) -> None:
    if name not in known:
        found = "" if place.endswith(f" {name}") else f'found "{name}"; '
        raise UserError(
            f"{place}: {found}model {model.title} has no such {kind}{did_you_mean(name, known)}; expected {', '.join(known)}"
        )
