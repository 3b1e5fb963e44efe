"""Where equations draw random numbers: a simulation needs equations that give the same at every call."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from dataclasses import dataclass
from types import FrameType
from typing import Any, TypeVar

import torch
from torch.utils._python_dispatch import TorchDispatchMode

Result = TypeVar("Result")


@dataclass(frozen=True)
class Draw:
    """The name of an operation of torch that draws random numbers, and the frame of the equations that it is called from, if any."""

    name: str
    frame: FrameType | None


def watched(function: Callable[[], Result], files: Collection[str]) -> tuple[Result, Draw | None]:
    """What a call returns, and the first draw of random numbers from torch's own generator in it.

    The operations of this thread are watched, not the state of the generator, which other threads draw from.

    Args:
        files: of the equations.
    """
    with _Watch(files) as watch:
        result = function()
    return result, watch.found


class _Watch(TorchDispatchMode):
    def __init__(self, files: Collection[str]) -> None:
        super().__init__()
        self._files = files
        self.found: Draw | None = None

    @classmethod
    def _should_skip_dynamo(cls) -> bool:
        """Nothing is compiled here: to be told to skip it, torch would import its compiler, which takes a second."""
        return False

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        given = kwargs or {}
        if self.found is not None or torch.Tag.nondeterministic_seeded not in func.tags:
            return func(*args, **given)
        before = torch.get_rng_state()
        made = func(*args, **given)
        # what may draw need not: attention without dropout, a generator of its own
        if not torch.equal(before, torch.get_rng_state()):
            frame: FrameType | None = sys._getframe(1)
            while frame is not None and frame.f_code.co_filename not in self._files:
                frame = frame.f_back
            self.found = Draw(func._schema.name.removeprefix("aten::"), frame)
        return made
