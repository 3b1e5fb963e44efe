"""The verdict: what `diagnose` says, in the form that `verdict.json` and the report are made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from greybox_torch.diagnosis.at_bounds import own_at_bounds
from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.not_tried import NotTried
from greybox_torch.diagnosis.of_no_use import of_no_use
from greybox_torch.diagnosis.own_parameters import Estimate, determined_together
from greybox_torch.diagnosis.parts import about_sizes
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget, changed_settings
from greybox_torch.diagnosis.traces import InputTrace, Trace
from greybox_torch.diagnosis.without_effects import WithoutEffects
from greybox_torch.diagnosis.worse_outputs import worse_outputs
from greybox_torch.estimate.comparison import Score, fit_rows, mostly_in
from greybox_torch.estimate.metrics import digits_between, told_fit

SCHEMA = "greybox-verdict/2"


@dataclass(frozen=True)
class Left:
    """What the recommended model leaves on the validation experiments: ``share`` of the refitted plain model's mean squared error beyond
    the noise, root mean square error in ``times_noise``, and a ``sentence`` for a reader.
    """

    share: float
    times_noise: float
    sentence: str


OF_ESTIMATION = "On the experiments that it was estimated from"
"""How the second sentence of what is left begins."""

STOPPED = "The search was stopped before it was done (time limit or interruption): this is what it had found by then."


@dataclass(frozen=True)
class Verdict:
    """Everything that a diagnosis found.

    ``scores`` by model name ("start", "refit", "augmented"), each a list in the same order; ``evidence`` sentences for a reader;
    ``stages`` seconds by stage; ``ranking`` rows (port, mechanism, share explained in the screen, gain after refit or None).
    """

    dataset: str
    model: str
    seed: int
    seconds: float
    confidence: float
    effects: tuple[Effect, ...]
    scores: Mapping[str, tuple[Score, ...]]
    evidence: tuple[str, ...]
    stages: Mapping[str, float]
    ranking: tuple[tuple[str, str, float, float | None], ...]
    traces: tuple[Trace, ...] = field(repr=False, default=())
    inputs: tuple[InputTrace, ...] = field(repr=False, default=())
    complete: bool = True
    """Whether the search ran to its end, rather than into a time limit or an interruption."""
    unexplained: float | None = None
    """How many times the noise the error is where nothing was found that explains it, if clearly more than noise: over windows or in free
    runs, whichever say less."""
    refinements: tuple[Effect, ...] = ()
    """What is significant and small beside the findings; in the model where there are findings, never in the headline."""
    left: Left | None = None
    unstable: frozenset[str] = frozenset()
    """Validation experiments that the recommended model simulates worse than the re-estimated one, as no free run of it follows them."""
    no_longer_validation: tuple[str, ...] = ()
    """A sentence for each validation experiment that was taken to choose with, and so is not in the validation fit."""
    short_validation: tuple[str, ...] = ()
    """A sentence where the validation experiments are short beside those of estimation or beside times of the machine."""
    too_short: str = ""
    """A clause where the recordings to choose with are too short to tell anything from chance."""
    unsure: str = ""
    """A clause where something would explain much of what nothing explains, and is not sure."""
    disturbed: float | None = None
    """How many times the noise it is where nothing was found, and what is left may be a disturbance that nobody measured."""
    question: str | None = None
    """Whether channels are exchanged or turned, without its full stop, where that would explain much of the mismatch."""
    question_first: str = ""
    """What the sentence begins with where the change explains far more than the effects do: what is asked, and what was changed."""
    settings: DiagnosisSettings = DiagnosisSettings()
    """By what it was decided, and with ``budget`` how much was computed for it."""
    budget: SearchBudget = SearchBudget()
    not_tried: NotTried = field(default_factory=NotTried)
    parameters: tuple[Estimate, ...] = field(repr=False, default=())
    beliefs: Beliefs = NO_BELIEFS
    """What was known beforehand."""
    looked: bool = True
    """Whether there was anything to look for: beliefs may exclude every hypothesis."""

    @property
    def mismatch(self) -> bool:
        """Whether something is missing: what was found, or an error that nothing explains."""
        return bool(self.effects) or self.unexplained is not None

    @property
    def could_not_say(self) -> bool:
        """Whether something is missing, and the search was stopped before it could say what: no answer yet."""
        return self.mismatch and self.looked and not (self.effects or self.complete or self.too_short)

    @property
    def shown_effects(self) -> tuple[Effect, ...]:
        """The effects as a reader is shown them, the largest first: they are found in another order. ``effects`` keeps that."""
        return tuple(sorted(self.effects, key=lambda e: -e.size if np.isfinite(e.size) else np.inf))

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        if not self.effects:
            known = (self.unexplained, mostly_in(self.counted("refit")), self.looked, self.complete, self.too_short)
            tried = (self.beliefs.exclude_some, self.unsure or self.not_tried.points_to, self.disturbed)
            return WithoutEffects(self.model, self.confidence, *known, *tried).sentence
        parts = [e.headline for e in self.shown_effects]
        found = ", and ".join([", ".join(parts[:-1]), parts[-1]]) if len(parts) > 1 else parts[0]
        start = "The mismatch is" if all(e.one_of is None for e in self.effects) else "The mismatch:"
        if self.question_first:
            start = f"{self.question_first}:"
        so_far = "" if self.complete else "; so far, as the search was stopped"
        return f"{start} {found}{self._gain()}{so_far}."

    @property
    def about_sizes(self) -> tuple[str, ...]:
        """Sentences where the sizes are much less than what the effects account for together, or more than what remains leaves room for."""
        share = None if self.left is None or self.of_no_use else self.left.share
        return about_sizes(self.effects, self.refinements, share)

    @property
    def worse_outputs(self) -> tuple[str, ...]:
        """A sentence for each output that the model with the effects simulates worse on the validation experiments."""
        return worse_outputs(self.counted("refit"), self.counted("augmented"), self.traces) if self.effects else ()

    @property
    def of_no_use(self) -> tuple[str, ...]:
        """A sentence where something is missing and the model recommended simulates the validation experiments worse than a constant."""
        which = "augmented" if self.effects else "refit"
        return of_no_use(self.counted(which), bool(self.effects)) if self.mismatch else ()

    @property
    def asked(self) -> tuple[str, ...]:
        """The question as a sentence, where there is one."""
        return () if self.question is None else (f"{self.question}.",)

    @property
    def at_bounds(self) -> tuple[str, ...]:
        """A sentence where free parameters of the model itself ended at one of their bounds."""
        told = [(e.name, e.unit, e.refit, e.augmented, e.at_bound) for e in self.parameters]
        return own_at_bounds(told, bool(self.effects))

    @property
    def together(self) -> tuple[str, ...]:
        """A sentence where free parameters of the model itself are determined together alone."""
        return determined_together(self.parameters)

    def counted(self, model: str) -> tuple[Score, ...]:
        """The scores of a model ("start", "refit", "augmented") but for those on experiments that do not count (``unstable``)."""
        return tuple(s for s in self.scores[model] if s.experiment not in self.unstable)

    def _gain(self) -> str:
        if self.effects[0].made_up_for:
            return f"; {self.effects[0].made_up_for}"
        pairs = [
            (before.fit, after.fit)
            for before, after in zip(self.counted("refit"), self.counted("augmented"), strict=True)
            if before.role == "validation"
        ]
        if not pairs:
            return "; windows show it, as no free run follows these experiments" if self.unstable else ""
        before, after = (float(np.mean(side)) for side in zip(*pairs, strict=True))
        them = "it" if len(self.effects) == 1 else "them"
        but = f" (without {', '.join(sorted(self.unstable))}, which no free run follows)" if self.unstable else ""
        digits = digits_between(before, after)
        goes = f"the validation fit goes from {told_fit(before, digits)} to {told_fit(after, digits)}{but}"
        lead = "windows show it, while free runs say little: " if max(before, after) < 0.0 else ""
        return f"; {lead}with {them} {goes}"

    def as_json(self) -> dict[str, Any]:
        """The dictionary of `verdict.json` (contract sections 4 and 8).

        Beside that "settings": those that differ from their default, "not_tried": what was left when the search was stopped,
        and "beliefs": probabilities that were given beforehand, where any were.
        """
        return {
            "schema": SCHEMA,
            "dataset": self.dataset,
            "model": self.model,
            "seed": self.seed,
            "seconds": self.seconds,
            "mismatch": self.mismatch,
            "complete": self.complete,
            "confidence": self.confidence,
            "sentence": self.sentence,
            "effects": [e.as_json() for e in self.effects],
            "refinements": [e.as_refinement_json() for e in self.refinements],
            "left": None
            if self.left is None
            else {n: getattr(self.left, n) for n in ("share", "times_noise", "sentence")},
            "fit": fit_rows(self.scores),
            **({"unstable": sorted(self.unstable)} if self.unstable else {}),
            **({"question": self.question} if self.question else {}),
            "evidence": list(self.evidence),
            **{
                n: list(told)
                for n in ("at_bounds", "together", "worse_outputs", "short_validation")
                if (told := getattr(self, n))
            },
            "stages": dict(self.stages),
            "not_tried": self.not_tried.as_json(),
            "settings": changed_settings(self.settings, self.budget),
            **({"beliefs": dict(self.beliefs.given)} if self.beliefs.given else {}),
        }
