"""What was left when a diagnosis was stopped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from greybox_torch.diagnosis.one_of import spoken_at

MOST_NAMED = 12
"""Candidates not tried any more up to which a sentence names them all."""


@dataclass(frozen=True)
class NotTried:
    """What was left when a diagnosis was stopped: the ``stages`` that were cut short or left out, and the ``candidates`` (port, mechanism)
    of the present step that were not yet refitted; all that it offers, where its screen did not come to an end.
    """

    stages: tuple[str, ...] = ()
    candidates: tuple[tuple[str, str], ...] = ()

    def sentences(self) -> tuple[str, ...]:
        """For a reader."""
        told = []
        if self.stages:
            told.append(f"Not finished: {'; '.join(stage.partition(':')[0] for stage in self.stages)}.")
        if len(self.candidates) > MOST_NAMED:
            told.append(
                f"Not tried any more: {len(self.candidates)} mechanisms at ports, which verdict.json lists (not_tried)."
            )
        elif self.candidates:
            named = ", ".join(spoken_at(mechanism, port) for port, mechanism in self.candidates)
            told.append(f"Not tried any more: {named}.")
        return tuple(told)

    def as_json(self) -> dict[str, Any]:
        """Its entry `not_tried`."""
        return {
            "stages": list(self.stages),
            "candidates": [{"port": port, "mechanism": mechanism} for port, mechanism in self.candidates],
        }
