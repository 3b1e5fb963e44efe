"""Where equations draw random numbers: a simulation needs equations that give the same at every call."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from types import FrameType
from typing import Any

import torch
from torch.utils._python_dispatch import TorchDispatchMode


def drawn_at(function: Callable[[], Any], files: Collection[str]) -> tuple[str, FrameType | None]:
    """The name of the first operation of torch that draws random numbers in a call, "" for none, and where in ``files`` that stands."""
    with _Watch(files) as watch:
        function()
    return watch.found or ("", None)


class _Watch(TorchDispatchMode):
    def __init__(self, files: Collection[str]) -> None:
        super().__init__()
        self._files = files
        self.found: tuple[str, FrameType | None] | None = None

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        if self.found is None and torch.Tag.nondeterministic_seeded in func.tags:
            frame: FrameType | None = sys._getframe(1)
            while frame is not None and frame.f_code.co_filename not in self._files:
                frame = frame.f_back
            self.found = (func._schema.name.removeprefix("aten::"), frame)
        return func(*args, **(kwargs or {}))
