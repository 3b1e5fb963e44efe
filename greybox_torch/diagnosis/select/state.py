"""Where a search stands: values that no step changes; every step makes new ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.screens import Screens
from greybox_torch.mechanisms.attachment import Attachment


@dataclass(frozen=True)
class SelectionStep:
    """One forward step: the scores of the screen by window length, the hypothesis that was built on, the refitted candidates, best first,
    and which of them was taken (None: nothing). ``led``: which would have been by the recordings alone, where beliefs put another first.
    """

    screened: tuple[tuple[ScreenScore, ...], ...]
    parent: Hypothesis
    ranked: tuple[RankedCandidate, ...]
    taken: RankedCandidate | None
    led: RankedCandidate | None = None


@dataclass(frozen=True, eq=False)
class SearchState:
    """The model as it stands (``plain``), the hypothesis so far (``current``), and the steps that led to it.

    ``without``: by effect, the current hypothesis refitted without it; empty until that was compared. ``named``: effects with names that
    were found in the place of a free curve that goes farther. ``memory``: the model with a residual with memory alone, where that
    was tried in the place of all that was found, or what was left of it. ``found_before``: what a search with fewer experiments came to.
    ``made_up_for``: effects that others made up for, each with the hypothesis that it was last in. ``in_place_of``: the step that took the
    free curve in whose place the names stand. ``by_free_runs``: whether free runs of held-out experiments chose the effects in the place of
    others, or of nothing, that windows preferred. ``screens``: makes the screens.
    """

    plain: Hypothesis
    current: Hypothesis
    steps: tuple[SelectionStep, ...] = ()
    without: Mapping[str, Hypothesis] = field(default_factory=dict)
    named: SearchState | None = None
    memory: SearchState | None = None
    found_before: Hypothesis | None = None
    made_up_for: tuple[tuple[Attachment, Hypothesis], ...] = ()
    in_place_of: SelectionStep | None = None
    by_free_runs: bool = False
    screens: Screens = field(default_factory=Screens)

    @property
    def memory_step(self) -> SelectionStep | None:
        """The step in which residuals with memory were offered alone."""
        return None if self.memory is None else self.memory.steps[-1]

    @property
    def effects(self) -> tuple[Attachment, ...]:
        """The effects of the hypothesis so far."""
        return self.current.effects

    @property
    def prefixes(self) -> set[str]:
        """What the names of their parameters begin with."""
        return {e.prefix for e in self.effects}

    @property
    def newest(self) -> str:
        """The prefix of the effect that was taken last (it may stand before others that were found earlier); empty without effects."""
        last = next((s.taken.candidate.attachment.prefix for s in reversed(self.steps) if s.taken is not None), "")
        return last if last in self.prefixes or not self.effects else self.effects[-1].prefix

    @property
    def has_curve(self) -> bool:
        """Whether one of them is a free curve or response."""
        return any(e.mechanism.free for e in self.effects)

    @property
    def took_one(self) -> bool:
        """Whether the last step took an effect."""
        return bool(self.steps) and self.steps[-1].taken is not None

    @property
    def compared_without(self) -> bool:
        """Whether ``without`` is known for every effect."""
        return set(self.without) == self.prefixes

    def step_of(self, prefix: str) -> SelectionStep | None:
        """The step in which an effect was taken, the last one where it was chosen anew beside the others."""
        return next(
            (s for s in reversed(self.steps) if s.taken is not None and s.taken.candidate.attachment.prefix == prefix),
            None,
        )

    def step_beside_others(self, prefix: str) -> SelectionStep | None:
        """The step in which an effect was taken, without the rivals that were found themselves since: they are not in its place.

        Seen: a servo's pendulum, told as "Coulomb friction, or a sensor's lag" and the sensor's lag.
        """
        done = self.step_of(prefix)
        if done is None or done.taken is None:
            return done
        found = self.prefixes - {prefix}
        return replace(done, ranked=tuple(r for r in done.ranked if r.candidate.attachment.prefix not in found))

    def with_law(self, effect: Attachment, law: Attachment) -> tuple[Attachment, ...]:
        """The effects with ``law`` in the place of ``effect``."""
        return tuple(law if e.prefix == effect.prefix else e for e in self.effects)

    def at(self, current: Hypothesis) -> SearchState:
        """With another hypothesis so far, of which it is not known what it is without its effects."""
        return replace(self, current=current, without={})
