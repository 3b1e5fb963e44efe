"""What recordings cannot tell apart, said as one statement (contract section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from greybox_torch.diagnosis.digits import digits
from greybox_torch.name_lists import listed

MUCH_LIKELIER = 5.0
"""Times as probable as another that the likeliest has to be for the two to be no longer "not told apart"."""

DECIDED_BY = "no recording tells them apart, only what is known of the machine does (the table [beliefs] of the card)"
"""What is said of hypotheses that are one effect in a model."""


@dataclass(frozen=True)
class Alternative:
    """A hypothesis with its probability, and the first parameter of its law, ``value`` None where that is not told.

    ``one_effect``: it is one effect with the finding in the model's equations, so that no recording tells them apart.
    """

    port: str
    mechanism: str
    probability: float
    parameter: str = ""
    value: float | None = None
    unit: str = ""
    one_effect: bool = False

    def as_json(self) -> dict[str, Any]:
        """Its entry under `alternatives` or `members`."""
        told: dict[str, Any] = {"port": self.port, "mechanism": self.mechanism, "probability": self.probability}
        if self.value is not None:
            told |= {"parameter": self.parameter, "value": self.value, "unit": self.unit}
        return told | ({"one_effect": True} if self.one_effect else {})

    @property
    def told_value(self) -> str:
        """Its parameter with value and unit, "bias = 87.5 W"; "" where that is not told."""
        return "" if self.value is None else f"{self.parameter} = {digits(self.value, 3)} {self.unit}".rstrip()


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

    @property
    def not_told_apart(self) -> tuple[Alternative, ...]:
        """The likeliest member, and those that are not much less likely."""
        return tuple(m for m in self.members if MUCH_LIKELIER * m.probability >= self.members[0].probability)

    @property
    def not_ruled_out(self) -> tuple[Alternative, ...]:
        """The others. Seen: "do not tell apart: sensor lag (0.85), input lag (0.02)", which contradicts itself."""
        return tuple(m for m in self.members if m not in self.not_told_apart)

    @property
    def told(self) -> str:
        """What the recordings say of the members, without a full stop."""
        alike, others = self.not_told_apart, self.not_ruled_out
        if not others:
            return f"these recordings do not tell apart: {with_shares(alike)}"
        if len(alike) == 1:
            return (
                f"by far the likeliest is {with_shares(alike)}; these recordings do not rule out {with_shares(others)}"
            )
        return f"these recordings do not tell apart: {with_shares(alike)}; less likely, and not ruled out: {with_shares(others)}"

    @property
    def in_brief(self) -> str:
        """The same by the number of laws, as a sentence."""
        alike, others = len(self.not_told_apart), len(self.not_ruled_out)
        if alike == 1:
            return f"One law is by far the likeliest; these recordings do not rule out {others} {'other' if others == 1 else 'others'}."
        return f"These recordings do not tell {alike} laws apart{f', and do not rule out {others} more' if others else ''}."

    @property
    def one_effect(self) -> tuple[Alternative, ...]:
        """The finding, which is the first member, and those that are one effect with it in the model; none where none is."""
        same = tuple(m for m in self.members[1:] if m.one_effect)
        return (self.members[0], *same) if same else ()

    @property
    def told_one_effect(self) -> str:
        """In a sentence, that no recording tells these members apart, and what does; "" where there are none."""
        same = self.one_effect
        if not same:
            return ""
        if len(same) == len(self.members):
            return f"in this model they are one effect: {DECIDED_BY}"
        named = listed([spoken_at(m.mechanism, m.port) for m in same])
        return f"in this model {named} are one effect: {DECIDED_BY}"

    @property
    def separable(self) -> bool:
        """Whether there are members that a recording may tell from the finding."""
        return len(self.one_effect) < len(self.members)

    def finding_with(self, value: float) -> OneOf:
        """The same with another value of the finding's parameter, where that is told: windows and whole records differ a little."""
        first, *rest = self.members
        return self if first.value is None else replace(self, members=(replace(first, value=value), *rest))

    def as_json(self) -> dict[str, Any]:
        """Its entry `one_of`."""
        return {
            "statement": self.statement,
            "probability": self.probability,
            "members": [m.as_json() for m in self.members],
        }


PERSONS = ("coulomb", "stribeck")
"""Whose names are parts of the names of mechanisms."""


SPOKEN = {"torque_saturation": "input saturation", "actuator_deadzone": "input dead zone"}
"""Mechanisms whose name says less than what they are: the input that saturates may be a flow, a voltage or a valve. A dead zone of the
actuator is at the port "actuator" anyway.
"""


def in_words(mechanism: str) -> str:
    """A mechanism's name as words, the names of persons in capitals."""
    if mechanism in SPOKEN:
        return SPOKEN[mechanism]
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


def with_shares(hypotheses: Sequence[Alternative]) -> str:
    """Hypotheses as a list, each with its probability and its value where that is told."""
    return ", ".join(
        f"{spoken_at(h.mechanism, h.port)} ({', '.join(filter(None, [f'{h.probability:.2f}', h.told_value]))})"
        for h in hypotheses
    )
