"""What a warning about data consists of."""

from __future__ import annotations

from typing import Protocol


class DataWarning(Protocol):
    """``found`` says what is there, ``write`` what to write instead."""

    @property
    def found(self) -> str: ...

    @property
    def write(self) -> str: ...


class InASentence:
    """A :class:`DataWarning` that as text is both in a sentence."""

    def __str__(self: DataWarning) -> str:
        return f"{self.found}; write: {self.write}"
