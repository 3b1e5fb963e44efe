"""What was left when a diagnosis was stopped, and what its screen had pointed to by then."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.progress import Journal, Named, Pointed
from greybox_torch.name_lists import listed

MOST_NAMED = 12
"""Candidates not tried any more up to which a sentence names them all."""


@dataclass(frozen=True)
class NotTried:
    """What was left when a diagnosis was stopped: the ``stages`` that were cut short or left out, and the ``candidates`` (port, mechanism)
    of the present step that were not yet refitted; all that it offers, where its screen did not come to an end. ``pointed_at``: what the
    first screen put first, each with the share of the error that it explains there, where no step of the search came to its end.
    """

    stages: tuple[str, ...] = ()
    candidates: tuple[Named, ...] = ()
    pointed_at: tuple[Pointed, ...] = ()

    @staticmethod
    def of(complete: bool, cut: tuple[str, ...], journal: Journal, decided: bool) -> NotTried:
        """What the ``journal`` of a diagnosis says of it; nothing where that is ``complete``.

        Args:
            cut: the stages that were cut short.
            decided: whether a step of the search came to its end: it says more than its screen.
        """
        return NotTried() if complete else NotTried(cut, journal.left, () if decided else journal.pointed)

    @property
    def points_to(self) -> str:
        """A clause on what the screen put first; "" where nothing is known, or more than that."""
        if not self.pointed_at:
            return ""
        first, *others = (
            f"{spoken_at(law, port)} ({digits(100 * share, 3)} %)" for (port, law), share in self.pointed_at
        )
        before = f", before {listed(others)}" if others else ""
        return f"the screen points to {first}{before}, by the share of the error over windows explained there, which is not confirmed"

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
        """Its entry `not_tried`; `pointed_at` where there is any."""
        pointed = [{"port": port, "mechanism": law, "share": share} for (port, law), share in self.pointed_at]
        return {
            "stages": list(self.stages),
            "candidates": [{"port": port, "mechanism": mechanism} for port, mechanism in self.candidates],
            **({"pointed_at": pointed} if pointed else {}),
        }
