"""Where a diagnosis stands, told while it runs, and what it had still to do when it was stopped."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from greybox_torch.diagnosis.one_of import spoken_at

Named = tuple[str, str]
"""A port, and the mechanism there."""

Pointed = tuple[Named, float]
"""With the share of the error that it explains in a screen."""


@dataclass(frozen=True)
class Progress:
    """Where a diagnosis stands after ``seconds``: what it is ``doing``, and the ``leading`` finding in words (empty while there is none).

    ``effects`` are its ports and mechanisms, and ``explained`` the share of the mismatch that they remove together, on the experiments that
    are chosen with; None while they are only what the screen points at.
    """

    seconds: float
    doing: str = ""
    leading: str = ""
    effects: tuple[Named, ...] = ()
    explained: float | None = None


class Journal:
    """Keeps where a diagnosis stands and tells ``hear`` of every change, from whatever thread it comes."""

    def __init__(self, hear: Callable[[Progress], None] = lambda progress: None) -> None:
        self._hear, self._began, self._now = hear, time.perf_counter(), Progress(0.0)
        self._lock, self._left, self._tests = threading.Lock(), dict[Named, None](), 0
        self._pointed: tuple[Pointed, ...] = ()

    def doing(self, text: str) -> None:
        """What is begun now."""
        self._tell(doing=text)

    def found(self, effects: Sequence[Named], explained: float) -> None:
        """The effects of the best state so far, and the share of the mismatch that they remove together."""
        named = _listed(effects)
        leading = f"{named}: {100 * explained:.3g} % of the mismatch explained" if effects else ""
        self._tell(leading=leading, effects=tuple(effects), explained=explained if effects else None)

    def pointed_at(self, first: Pointed, *others: Pointed) -> None:
        """What the screen puts first, and behind it; told of is the first, and nothing where more is known already."""
        with self._lock:
            self._pointed = (first, *others)
        effect, share = first
        if self._now.explained is None:
            self._tell(leading=f"perhaps {_listed([effect])}: {100 * share:.3g} % in the screen", effects=(effect,))

    def offer(self, candidates: Iterable[Named]) -> None:
        """Candidates that are to be screened, or refitted, now."""
        with self._lock:
            self._left = dict.fromkeys(candidates)

    def begin(self, candidate: Named) -> None:
        """One of them is."""
        with self._lock:
            self._left.pop(candidate, None)

    def screened(self, tests: int) -> None:
        """A screen has ended that made so many tests of a mechanism at a port."""
        with self._lock:
            self._tests += tests

    @property
    def pointed(self) -> tuple[Pointed, ...]:
        """What the last screen beside no effect put first, best first."""
        return self._pointed

    @property
    def tests(self) -> int:
        """Those of all screens that have ended."""
        return self._tests

    @property
    def left(self) -> tuple[Named, ...]:
        """Those that were never begun with."""
        return tuple(self._left)

    def _tell(self, **changes: object) -> None:
        with self._lock:
            self._now = replace(self._now, seconds=time.perf_counter() - self._began, **changes)
        self._hear(self._now)


def _listed(effects: Sequence[Named]) -> str:
    return ", and ".join(spoken_at(mechanism, port) for port, mechanism in effects)
