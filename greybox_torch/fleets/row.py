"""One line of the fleet's table: what came of one data set."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from greybox_torch.data.card import Card

ANSWERS = ("named", "unknown", "nothing", "unfinished", "failed")
"""An effect with a name; something missing without one; nothing missing; stopped by the time limit before any answer; no verdict."""


@dataclass(frozen=True)
class Row:
    """Of one data set; a field that does not apply is None or empty.

    ``dataset`` is its name in the fleet and the folder of its results, ``title`` the card's name, ``machine`` what was recorded and
    ``recorded`` when (ISO 8601). ``answer`` is one of :data:`ANSWERS`. ``effect`` names the leading effect as the headline has it, with
    its ``port``, ``mechanism`` and ``probability``; ``parameter`` is its first one, ``value`` with standard deviation ``std`` in
    ``unit``. ``fit_before`` and ``fit_after`` are means over the validation experiments in %. ``parameters`` are all that were estimated,
    each with value, std and unit. ``failure`` is "input", "numbers", "memory", "killed" or "error", and ``message`` says what it was.
    ``fingerprint`` is of all that the verdict depends on.
    """

    dataset: str
    card: str
    answer: str
    machine: str = ""
    recorded: str | None = None
    title: str = ""
    model: str = ""
    sentence: str = ""
    confidence: float | None = None
    effect: str = ""
    port: str = ""
    mechanism: str = ""
    probability: float | None = None
    parameter: str = ""
    value: float | None = None
    std: float | None = None
    unit: str = ""
    fit_before: float | None = None
    fit_after: float | None = None
    seconds: float = 0.0
    complete: bool = True
    failure: str = ""
    message: str = ""
    report: str = ""
    fingerprint: str = ""
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def described(self, card: Card) -> Row:
        """The row with what the card says of the machine."""
        recorded = None if card.recorded is None else card.recorded.isoformat()
        return dataclasses.replace(self, machine=card.machine or self.dataset, recorded=recorded, title=card.name or "")

    @property
    def failed(self) -> bool:
        return self.answer == "failed"

    @property
    def card_read(self) -> bool:
        """Whether the card could be read, which says of which machine it is: what fails behind it leaves something of it in the row."""
        told = self.title or self.recorded or self.fingerprint or self.machine != self.dataset
        return self.failure != "input" or bool(told)

    @property
    def day(self) -> float:
        """Days since 1970-01-01 when it was recorded, minus infinity where that is not known; a date without a zone is taken as of UTC."""
        if not self.recorded:
            return float("-inf")
        at = datetime.fromisoformat(self.recorded)
        return (at if at.tzinfo else at.replace(tzinfo=UTC)).timestamp() / 86400.0

    @property
    def key_parameter(self) -> str:
        """Its full name among ``parameters``; empty where there is none."""
        return f"{self.port}.{self.mechanism}.{self.parameter}" if self.parameter else ""

    def as_json(self) -> dict[str, Any]:
        """Its line in `fleet.jsonl`."""
        return dataclasses.asdict(self)

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Row:
        """The row of a line that :meth:`as_json` has made.

        Raises:
            ValueError: it is of another form, such as one that another version has written.
        """
        known = {entry.name for entry in dataclasses.fields(cls)}
        if not isinstance(content, dict) or not set(content) <= known or content.get("answer") not in ANSWERS:
            raise ValueError("not a row of a fleet's table")
        try:
            return cls(**content)
        except TypeError as error:
            raise ValueError(str(error)) from None
