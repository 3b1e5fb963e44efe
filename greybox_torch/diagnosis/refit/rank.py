"""Naming: full refits of the leading hypotheses, and the choice between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.degenerate import degenerate
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, augmented, score_of, window_lengths, without_free
from greybox_torch.diagnosis.hypothesis.significance import white_samples, window_significance
from greybox_torch.diagnosis.refit.curve import laws_on_curve
from greybox_torch.diagnosis.refit.finalists import finalists, leading_and_rest
from greybox_torch.diagnosis.refit.order import in_better_order, in_both_orders, joined
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.refit.richer_forms import richer_forms
from greybox_torch.diagnosis.refit.twins import from_twin
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import problem_for
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut

Shown = tuple[float, Hypothesis, int]
"""How far a trial is from the hypothesis before it (negative: better), the trial, and the length of its windows in samples."""


@dataclass(frozen=True)
class RankedCandidate:
    """A refitted hypothesis with its newest effect; ``gain``: by how much its score is below that of the one before, ``significance``: by
    how many standard errors over windows.
    """

    candidate: Candidate
    fitted: Hypothesis
    gain: float
    significance: float
    cost: float | None = None
    """Negative logarithm of the likelihood of whole records, errors coloured, where others fit windows alike and noise alone is left."""

    @property
    def unknown(self) -> bool:
        """Whether the newest effect is a free curve rather than a law."""
        return self.candidate.unknown

    @property
    def size(self) -> int:
        """How many parameters the newest effect has to adjust."""
        start = f"{self.candidate.attachment.prefix}."
        return sum(name.startswith(start) for name in self.fitted.problem.free_names)


def in_order(ranked: Sequence[RankedCandidate], settings: DiagnosisSettings) -> list[RankedCandidate]:
    """Best first: by score, with a price for every parameter: of laws that fit alike, the simpler one is meant.

    Where the best leaves white noise alone the price is log(N) / N for N samples, by which a law is likelier. Where more is left, errors
    are neither white nor only the lacking effect's, and the samples say less than their number.

    Source: G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6, 1978.
    """
    best = min((r.fitted for r in ranked), key=lambda h: h.score, default=None)
    samples = 0 if best is None else white_samples(best, settings)
    price = min(settings.parameter_price, float(np.log(samples)) / samples) if samples else settings.parameter_price
    return sorted(ranked, key=lambda r: r.fitted.score + price * r.size)


def rank(
    study: Study, current: Hypothesis, found: Sequence[Candidate], to_beat: Hypothesis | None = None
) -> list[RankedCandidate]:
    """Refit every candidate on top of ``current`` and rank them, best first.

    Args:
        to_beat: what a candidate has to come near in its trial to be refitted in full; by default ``current``.
    """
    budget = study.budget
    study.journal.offer(candidate.attachment.named for candidate in found)
    found = in_both_orders(study, current.effects, found)
    frozen = frozenset(
        p.name for p in current.model.declared_parameters if p.shrunk
    )  # heights of a curve: many, and good already
    simulators = _compiled(study, current, found, frozen)
    at = window_lengths(study.problem, budget)
    middle = at[min(1, len(at) - 1)]
    steps = {length: cut(study.problem.records, length).steps for length in at}
    allowance = study.settings.trial_allowance
    refit = partial(fit, study, shorter=current.fits[0], frozen=frozen, rough=True)

    def tried(
        candidate: Candidate, simulator: Simulator, starts: Sequence[Mapping[str, float]] = (), length: int = middle
    ) -> Hypothesis | None:
        study.working_on(f"refitting {candidate.attachment.prefix}")
        study.journal.begin(candidate.attachment.named)
        effects = joined(current.effects, candidate)
        starts = starts or candidate.first_starts(budget.trial_starts)
        return refit(effects, starts, at=[length], limits=budget.trial_iterations, simulator=simulator)

    def compared(trial: Hypothesis | None, length: int) -> list[Shown]:
        """How far a trial is from the hypothesis before it (negative: better), where it is not hopeless."""
        before, standing = (_score_over(h, steps[length]) for h in (current, to_beat or current))
        hopeless = trial is None or trial.score >= standing + allowance
        return [] if trial is None or hopeless else [(trial.score - before, trial, length)]

    def over_promised(candidate: Candidate, simulator: Simulator, lengths: Iterable[int]) -> list[Shown]:
        """Its trials over those windows of ``lengths`` where the screen promises much of it; over all where it was found before."""
        promised = candidate.explained >= study.settings.trial_promise
        shows = [n for n in lengths if candidate.found_before or (promised and steps[n] == candidate.steps)]
        there = [n for n in shows if n != middle]
        return [shown for n in there for shown in compared(tried(candidate, simulator, length=n), n)]

    def where_it_shows(candidate: Candidate, simulator: Simulator, own: Hypothesis | None) -> Shown | None:
        """Its trial over windows of middle length, or over those where the screen promises much of it if it does not show there."""
        found = compared(own, middle)
        if not (found and found[0][0] < -allowance):
            found += over_promised(candidate, simulator, at)
        return min(found, key=lambda shown: shown[0], default=None)

    def where_others_show(candidate: Candidate, simulator: Simulator, own: Shown | None) -> Shown | None:
        """Its trial where it shows or, where others are compared over longer windows, also there: those have more to remove."""
        found = [] if own is None else [own, *(over_promised(candidate, simulator, others) if own[2] == middle else ())]
        return min(found, key=lambda shown: shown[0], default=None)

    def in_full(candidate: Candidate, before: Hypothesis, simulator: Simulator) -> RankedCandidate | None:
        study.working_on(f"refitting {candidate.attachment.prefix} in full")
        fitted = refit(
            before.effects,
            [before.values()],
            early=[*candidate.first_starts(budget.trial_starts), *_elsewhere(study, candidate, before)],
            before=before,
            limits=budget.window_iterations,
            simulator=simulator,
        )
        return None if fitted is None else judged(candidate, current, fitted, study.settings)

    pairs = list(zip(found, simulators, strict=True))
    reached = side_by_side(partial(tried, *pair) for pair in pairs)
    known = list(zip(found, reached, strict=True))

    def tried_again(candidate: Candidate, simulator: Simulator, own: Hypothesis | None) -> Hypothesis | None:
        start = from_twin(candidate, own, known, study.settings.score_tie)
        starts = [start] if start else []
        if candidate.absent and (own is None or own.score > _score_over(current, steps[middle])):
            without = next(f for f in current.fits if f.windows.steps == steps[middle])
            starts.append(
                {**without.problem.values_by_name, **candidate.absent}
            )  # worse than without it: begun too far away
        again = tried(candidate, simulator, starts) if starts else None
        return again if again is not None and (own is None or again.score < own.score) else own

    reached = side_by_side(partial(tried_again, *pair, own) for pair, own in zip(pairs, reached, strict=True))
    shown = side_by_side(partial(where_it_shows, *pair, own) for pair, own in zip(pairs, reached, strict=True))
    if others := {one[2] for one in shown if one is not None} - {middle}:
        shown = side_by_side(partial(where_others_show, *pair, own) for pair, own in zip(pairs, shown, strict=True))
    first = [
        (trial[0], candidate, trial[1], simulator)
        for trial, (candidate, simulator) in zip(shown, pairs, strict=True)
        if trial is not None
    ]
    first = in_better_order(first)
    final: list[RankedCandidate] = []
    for some in leading_and_rest(study, finalists(first, study)):
        if any(_pays(study, r) for r in final):
            break
        # Curves take longest: begun last, they would leave the other cores idle.
        longest_first = sorted(some, key=lambda entry: not entry[1].unknown)
        final += [r for r in side_by_side(partial(in_full, *entry[1:]) for entry in longest_first) if r is not None]
    return in_order([*final, *_laws_behind_curve(study, current, final, frozen)], study.settings)


def _elsewhere(study: Study, candidate: Candidate, trial: Hypothesis) -> list[dict[str, float]]:
    """Where the law says that a refit may begin once more after its trial."""
    effect, values = candidate.attachment, trial.values()
    own = {n.rpartition(".")[2]: v for n, v in values.items() if n.startswith(f"{effect.prefix}.")}
    others = effect.mechanism.begun_elsewhere(study.surroundings[effect.port], own)
    return [{**values, **{f"{effect.prefix}.{n}": v for n, v in other.items()}} for other in others]


def _score_over(fitted: Hypothesis, steps: int) -> float:
    """The score over windows of one length, in steps."""
    return score_of([f for f in fitted.fits if f.windows.steps == steps], fitted.floor)


def judged(
    candidate: Candidate, before: Hypothesis, fitted: Hypothesis, settings: DiagnosisSettings
) -> RankedCandidate:
    """A refit compared with the hypothesis ``before`` it."""
    return RankedCandidate(
        candidate, fitted, before.score - fitted.score, window_significance(before, fitted, settings)
    )


def _pays(study: Study, ranked: RankedCandidate) -> bool:
    """Whether a named candidate improves on the hypothesis before it, surely, and by a law that says something of the machine."""
    settings = study.settings
    improves = ranked.gain > settings.least_gain and ranked.significance > settings.least_significance
    return improves and not ranked.unknown and sound(study, ranked)


def sound(study: Study, ranked: RankedCandidate) -> bool:
    """Whether the newest effect's parameters, as they were refitted, say something of the machine."""
    return degenerate(ranked.candidate.attachment, study.surroundings, ranked.fitted.values()) is None


def _laws_behind_curve(
    study: Study, current: Hypothesis, final: Sequence[RankedCandidate], frozen: frozenset[str]
) -> list[RankedCandidate]:
    """Where a free curve leads: the named laws of the same signal at the same port, refitted from what the curve has learned.

    Not those that have come as far as the curve by themselves.
    """
    best = min(final, key=lambda r: r.fitted.score, default=None)
    if best is None or not isinstance(best.candidate.attachment.mechanism, Unknown):
        return []
    within = best.fitted.score + study.settings.score_tie
    there = {identity_of(r.candidate.attachment) for r in final if r.fitted.score < within}

    def tried(candidate: Candidate) -> RankedCandidate | None:
        study.working_on(f"refitting {candidate.attachment.prefix} from the curve")
        effects = joined(current.effects, candidate)
        limits, shorter = study.budget.window_iterations, best.fitted.fits[0]
        fitted = fit(study, effects, candidate.starts, shorter, limits=limits, frozen=frozen)
        return None if fitted is None else judged(candidate, current, fitted, study.settings)

    laws = laws_on_curve(study.problem.model, best.fitted, best.candidate.attachment, study.surroundings, study.card)
    allowed = [
        law for law in laws if not study.beliefs.exclude(law.attachment) and identity_of(law.attachment) not in there
    ]
    tries = in_both_orders(study, current.effects, allowed)
    behind = [r for r in side_by_side(partial(tried, law) for law in tries) if r is not None]
    # A law that removes a part of it would else give way to the richer form of another one, at another port.
    in_part = [r for r in final if not r.unknown and 0.0 < r.gain < study.settings.named_share * best.gain]
    richer = richer_forms(study, best.candidate.attachment.port, [(r.candidate, r.fitted) for r in in_part])
    forms = side_by_side(partial(tried, law) for law in richer)
    return [*behind, *(r for r in forms if r is not None and r.fitted.score < within)]


def _compiled(study: Study, current: Hypothesis, found: Sequence[Candidate], frozen: frozenset[str]) -> list[Simulator]:
    """Simulators of the whole shortlist, compiled side by side."""

    def build(candidate: Candidate) -> Simulator:
        model = augmented(study.problem, joined(current.effects, candidate), study.surroundings)
        free = without_free(problem_for(study.problem, model, {}), frozen).free_names
        return current.simulator.for_model(model, free)

    return side_by_side(partial(build, candidate) for candidate in found)
