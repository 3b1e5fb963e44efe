"""What a model's equations tell of its structure is found once and kept for as long as the model."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, TypeVar
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel

Found = TypeVar("Found")


def once_per_model(find: Callable[[GreyBoxModel], Found]) -> Callable[[GreyBoxModel], Found]:
    """``find``, called once for every model object; for what depends on equations and declarations, never on parameter values."""
    kept: WeakKeyDictionary[GreyBoxModel, Found] = WeakKeyDictionary()

    @wraps(find)
    def found(model: GreyBoxModel) -> Found:
        if model not in kept:
            kept[model] = find(model)
        return kept[model]

    return found
