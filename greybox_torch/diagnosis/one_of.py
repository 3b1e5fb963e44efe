"""What recordings cannot tell apart, said as one statement (contract section 8)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Alternative:
    """A hypothesis with its probability."""

    port: str
    mechanism: str
    probability: float

    def as_json(self) -> dict[str, Any]:
        """Its entry under `alternatives` or `members`."""
        return {"port": self.port, "mechanism": self.mechanism, "probability": self.probability}


@dataclass(frozen=True)
class OneOf:
    """Hypotheses of which one is right, and that these recordings do not tell apart.

    ``statement`` says what they share; ``probability`` is that of the whole; ``members``, the likeliest first, share it.
    """

    statement: str
    probability: float
    members: tuple[Alternative, ...]

    @property
    def likeliest(self) -> str:
        """The first member's share, for a reader of the statement."""
        first = self.members[0]
        named = self.statement.startswith(spoken(first.mechanism))
        return f"{'the first' if named else spoken_at(first.mechanism, first.port)} {first.probability:.2f}"

    def as_json(self) -> dict[str, Any]:
        """Its entry `one_of`."""
        return {
            "statement": self.statement,
            "probability": self.probability,
            "members": [m.as_json() for m in self.members],
        }


PERSONS = ("coulomb", "stribeck")
"""Whose names are parts of the names of mechanisms."""


def in_words(mechanism: str) -> str:
    """A mechanism's name as words, the names of persons in capitals."""
    return " ".join(word.capitalize() if word in PERSONS else word for word in mechanism.split("_"))


def spoken(mechanism: str) -> str:
    """A mechanism's name as a sentence has it."""
    unknown = {
        "unknown": "an unknown effect",
        "unknown_with_memory": "an unknown effect with memory",
        "unknown_fading": "an unknown effect that fades",
        "unknown_map": "an unknown effect of two signals",
        "unknown_play": "an unknown effect with play",
        "unknown_rate_limit": "an unknown effect with a limit of the rate",
    }
    return unknown.get(mechanism) or in_words(mechanism)


def spoken_at(mechanism: str, port: str) -> str:
    """A mechanism and its place as a sentence has them."""
    return f"{spoken(mechanism)} at {port}"
