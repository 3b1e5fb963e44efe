"""How a model is found again: the text that a checkpoint keeps for it."""

from __future__ import annotations

import sys
from pathlib import Path

from greybox_torch.model import GreyBoxModel
from greybox_torch.systems.load import BUILT_IN


def model_reference(model: GreyBoxModel) -> str:
    """How to find the model again, effects aside: its built-in name, "file.py:Class", or "module.Class" for a class that is in no file of
    its own, such as a notebook's.
    """
    return model.plain.loaded_as or _reference(type(model.plain))


def defined_here(reference: str) -> type[GreyBoxModel] | None:
    """The class of that reference which this session has defined last; None where there is none. Nothing is run to find it."""
    found: type[GreyBoxModel] | None = None
    waiting: list[type[GreyBoxModel]] = [GreyBoxModel]
    while waiting:
        for made in waiting.pop().__subclasses__():
            found = made if _reference(made) == reference else found
            waiting.append(made)
    return found


def _reference(made: type[GreyBoxModel]) -> str:
    if BUILT_IN.get(made.name) is made:
        return made.name
    file = getattr(sys.modules.get(made.__module__), "__file__", None)
    if file and made.__module__ != "__main__" and made.__qualname__.isidentifier():
        return f"{Path(file).resolve()}:{made.__qualname__}"
    return f"{made.__module__}.{made.__qualname__}"
