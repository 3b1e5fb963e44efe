"""Naming: full refits of the leading hypotheses, and the choice between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import (
    POLISH_SETTINGS,
    Hypothesis,
    augmented,
    hypothesis,
    lengths,
    score_of,
    without_free,
)
from greybox_torch.diagnosis.hypothesis.significance import significance, white_samples
from greybox_torch.diagnosis.refit.curve import laws_on_curve
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut

FINALISTS = 3
"""Hypotheses that are fitted at all window lengths, after a first round at the middle one."""

HOPELESS = 0.05
"""How much worse than without it a hypothesis may be after its trial, in the score, to be refitted in full."""

TIE, MOST_TIED = 0.03, 6
"""Difference of the scores within which named hypotheses tie after the first round, and how many of those go on."""

TRIAL_SETTINGS = Settings(iterations=14, tolerance=1e-3, trials=5)
TRIAL_STARTS = 2
PARSIMONY = 0.003
"""Improvement of the logarithm of the mean squared error that a further parameter has to bring where more than noise is left."""


@dataclass(frozen=True)
class RankedCandidate:
    """A refitted hypothesis with its newest effect, its score (lower is better) and how significance it improves on the one before."""

    leader: Candidate
    fitted: Hypothesis
    gain: float
    significance: float
    cost: float | None = None
    """Negative logarithm of the likelihood of whole records, errors coloured, where others fit windows alike and noise alone is left."""

    @property
    def unknown(self) -> bool:
        return self.leader.unknown

    @property
    def size(self) -> int:
        """How many parameters the newest effect has to adjust."""
        start = f"{self.leader.attachment.prefix}."
        return sum(name.startswith(start) for name in self.fitted.problem.free_names)


def in_order(ranked: Sequence[RankedCandidate]) -> list[RankedCandidate]:
    """Best first: by score, with a price for every parameter: of laws that fit alike, the simpler one is meant.

    Where the best leaves white noise alone the price is log(N) / N for N samples, by which a law is likelier. Where more is left, errors
    are neither white nor only the lacking effect's, and the samples say less than their number.

    Source: G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6, 1978.
    """
    best = min((r.fitted for r in ranked), key=lambda h: h.score, default=None)
    samples = 0 if best is None else white_samples(best)
    price = min(PARSIMONY, float(np.log(samples)) / samples) if samples else PARSIMONY
    return sorted(ranked, key=lambda r: r.fitted.score + price * r.size)


def rank(
    base: Problem,
    current: Hypothesis,
    found: Sequence[Candidate],
    surroundings: Mapping[str, Surroundings],
    *,
    progress: Callable[[str], None] = lambda text: None,
) -> list[RankedCandidate]:
    """Refit every leader on top of ``current`` and rank them, best first."""
    frozen = frozenset(
        p.name for p in current.model.declared_parameters if p.shrunk
    )  # heights of a curve: many, and good already
    simulators = _compiled(base, current, found, surroundings, frozen)
    at = lengths(base)
    middle = at[min(1, len(at) - 1) :][:1]
    refit = partial(hypothesis, base, surroundings=surroundings, frozen=frozen, options=current.simulator.options)

    def tried(leader: Candidate, simulator: Simulator) -> Hypothesis | None:
        progress(f"refitting {leader.attachment.prefix}")
        effects = (*current.effects, leader.attachment)
        own = {"at": middle, "shorter": current.fits[0], "settings": TRIAL_SETTINGS, "simulator": simulator}
        return refit(effects, starts=leader.starts[:TRIAL_STARTS], **own)

    def in_full(leader: Candidate, before: Hypothesis, simulator: Simulator) -> RankedCandidate | None:
        progress(f"refitting {leader.attachment.prefix} in full")
        starts = [before.values(), *leader.starts[:TRIAL_STARTS]]
        fitted = refit(before.effects, starts=starts, shorter=current.fits[0], simulator=simulator)
        return None if fitted is None else judged(leader, current, fitted)

    pairs = list(zip(found, simulators, strict=True))
    trials = zip(side_by_side(partial(tried, *pair) for pair in pairs), pairs, strict=True)
    first = [(trial.score, leader, trial, simulator) for trial, (leader, simulator) in trials if trial is not None]
    at_middle = [f for f in current.fits if f.windows.steps == cut(base.records, middle[0]).steps]
    hopeless = score_of(at_middle, current.floor) + HOPELESS
    first = sorted((entry for entry in first if entry[0] < hopeless), key=lambda entry: entry[0])
    # Curves take longest: begun last, they would leave the other cores idle.
    longest_first = sorted(_finalists(first), key=lambda entry: not entry[1].unknown)
    final = [r for r in side_by_side(partial(in_full, *entry[1:]) for entry in longest_first) if r is not None]
    return in_order([*final, *_distilled(refit, current, final, surroundings, progress)])


def judged(leader: Candidate, before: Hypothesis, fitted: Hypothesis) -> RankedCandidate:
    """A refit compared with the hypothesis ``before`` it."""
    return RankedCandidate(leader, fitted, before.score - fitted.score, significance(before, fitted))


def _distilled(
    refit: partial[Hypothesis | None],
    current: Hypothesis,
    final: Sequence[RankedCandidate],
    surroundings: Mapping[str, Surroundings],
    progress: Callable[[str], None],
) -> list[RankedCandidate]:
    """Where a free curve leads: the named laws of the same signal at the same port, refitted from what the curve has learned."""
    best = min(final, key=lambda r: r.fitted.score, default=None)
    if best is None or not best.unknown:
        return []
    (base,) = refit.args
    card = dict(zip(base.names, map(float, base.values), strict=True))

    def tried(leader: Candidate) -> RankedCandidate | None:
        progress(f"refitting {leader.attachment.prefix} from the curve")
        fitted = refit((*current.effects, leader.attachment), starts=leader.starts, shorter=best.fitted.fits[0])
        return None if fitted is None else judged(leader, current, fitted)

    laws = laws_on_curve(base.model, best.fitted, best.leader.attachment, surroundings, card)
    return [r for r in side_by_side(partial(tried, law) for law in laws) if r is not None]


def polished(
    base: Problem,
    fitted: Hypothesis,
    surroundings: Mapping[str, Surroundings],
    starts: Sequence[Mapping[str, float]] = (),
) -> Hypothesis:
    """``fitted`` refitted to convergence, also from further start values; the better of the two."""
    again = hypothesis(
        base,
        fitted.effects,
        surroundings,
        [fitted.values(), *starts],
        shorter=fitted.fits[0],
        settings=POLISH_SETTINGS,
        simulator=None if fitted.frozen else fitted.simulator,
        options=fitted.simulator.options,
    )
    return fitted if again is None or again.score > fitted.score else again


def _finalists(
    first: list[tuple[float, Candidate, Hypothesis, Simulator]],
) -> list[tuple[float, Candidate, Hypothesis, Simulator]]:
    """The best few, the best few named ones and what ties with the best of those, what they generalise, and the best curve."""
    named = [e for e in first if not e[1].unknown]
    chosen = first[:FINALISTS]
    tied = [e for e in named[:MOST_TIED] if e[0] < named[0][0] + TIE]
    chosen += [e for e in named[: max(FINALISTS, len(tied))] if e not in chosen]
    contained = {(e[1].attachment.port, name) for e in chosen for name in e[1].attachment.mechanism.generalises}
    chosen += [
        e for e in first if (e[1].attachment.port, e[1].attachment.mechanism.name) in contained and e not in chosen
    ]
    if not any(e[1].unknown for e in chosen):
        chosen += [e for e in first if e[1].unknown][:1]
    return chosen


def _compiled(
    base: Problem,
    current: Hypothesis,
    found: Sequence[Candidate],
    surroundings: Mapping[str, Surroundings],
    frozen: frozenset[str],
) -> list[Simulator]:
    """Simulators of the whole shortlist, compiled side by side."""

    def build(leader: Candidate) -> Simulator:
        model = augmented(base, (*current.effects, leader.attachment), surroundings)
        return current.simulator.for_model(model, without_free(problem_for(base, model, {}), frozen).free_names)

    return side_by_side(partial(build, leader) for leader in found)
