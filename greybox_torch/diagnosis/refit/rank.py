"""Naming: full refits of the leading hypotheses, and the choice between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, augmented, score_of, window_lengths, without_free
from greybox_torch.diagnosis.refit.behind_curve import laws_behind_curve
from greybox_torch.diagnosis.refit.finalists import Trial, finalists, leading_and_rest
from greybox_torch.diagnosis.refit.order import in_better_order, in_both_orders, joined
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged, sound
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.refit.twins import from_contained, from_twin
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of, with_substeps
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import problem_for
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut

MOST_PROMISED = 0.99
"""Share of the error beyond which a screen promises no more."""

Tried = tuple[Candidate, Simulator, Hypothesis | None]
"""A candidate, what it is simulated with, and its trial."""

Shown = tuple[float, Hypothesis, int]
"""How far a trial is from the hypothesis before it (negative: better), the trial, and the length of its windows in samples."""


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
    frozen = frozenset(p.name for p in current.model.declared_parameters if p.shrunk)
    simulators = _compiled(study, current, found, frozen)
    at = window_lengths(study.problem, budget)
    middle = at[min(1, len(at) - 1)]
    steps = {length: cut(study.problem.records, length).steps for length in at}
    allowance = study.settings.trial_allowance
    refit = partial(fit, study, rough=True)

    def tried(
        candidate: Candidate, simulator: Simulator, starts: Sequence[Mapping[str, float]] = (), length: int = middle
    ) -> Hypothesis | None:
        study.working_on(f"refitting {candidate.attachment.prefix}")
        study.journal.begin(candidate.attachment.named)
        effects = joined(current.effects, candidate)
        starts = starts or candidate.first_starts(budget.trial_starts)
        how = {"shorter": candidate.begun or current.fits[0], "limits": budget.trial_iterations}
        return refit(effects, starts, at=[length], simulator=simulator, frozen=_held(candidate, frozen), **how)

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

    def where_it_shows(candidate: Candidate, simulator: Simulator, own: Shown | None) -> Shown | None:
        """Its trial over windows of middle length, or over those where the screen promises much of it if it does not show there."""
        found = [] if own is None else [own]
        if not (own is not None and own[0] < -allowance):
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
            shorter=candidate.begun or current.fits[0],
            early=[*candidate.first_starts(budget.trial_starts), *_elsewhere(study, candidate, before)],
            before=before,
            limits=budget.window_iterations,
            simulator=simulator,
            frozen=_held(candidate, frozen),
        )
        if candidate.absent and (fitted is None or fitted.score > current.score):
            fitted = from_absent(candidate, before, simulator, fitted)
        return None if fitted is None else judged(candidate, current, fitted, study.settings)

    def from_absent(
        candidate: Candidate, trial: Hypothesis, simulator: Simulator, fitted: Hypothesis | None
    ) -> Hypothesis | None:
        """Its fit from what was there before it, where it ended worse than that: another valley. As it is where that is no better."""
        begun = {**current.values(), **candidate.absent}
        how = {"simulator": simulator, "frozen": _held(candidate, frozen), "limits": budget.window_iterations}
        shorter, absent = candidate.begun or current.fits[0], candidate.absent
        again = refit(trial.effects, [begun, trial.values()], shorter, beside=current, absent=absent, **how)
        return again if again is not None and (fitted is None or again.score < fitted.score) else fitted

    pairs = list(zip(found, simulators, strict=True))
    reached = side_by_side(partial(tried, *pair) for pair in pairs)
    known = list(zip(found, reached, strict=True))

    def tried_again(candidate: Candidate, simulator: Simulator, own: Hypothesis | None) -> Hypothesis | None:
        taken_over = (of(candidate, own, known, study.settings.score_tie) for of in (from_twin, from_contained))
        starts = [start for start in taken_over if start]
        if candidate.absent and (own is None or own.score > _score_over(current, steps[middle])):
            without = next(f for f in current.fits if f.windows.steps == steps[middle])
            starts.append(
                {**without.problem.values_by_name, **candidate.absent}
            )  # worse than without it: begun too far away
        again = tried(candidate, simulator, starts) if starts else None
        return again if again is not None and (own is None or again.score < own.score) else own

    reached = side_by_side(partial(tried_again, *pair, own) for pair, own in zip(pairs, reached, strict=True))
    over_current = partial(_score_over, current, steps[middle])

    def in_finer_steps(candidate: Candidate, simulator: Simulator, own: Hypothesis | None) -> Tried:
        """Its trial with more sub-steps, where dry friction comes to less than promised, if it comes much farther so: they cost."""
        missing = _missing_of_promise(study, candidate, over_current(), own)
        if missing is None:
            return candidate, simulator, own
        finer = with_substeps(candidate, budget.substeps_of_dry_friction * simulator.options.substeps)
        (there,) = _compiled(study, current, [finer], frozen)
        again = tried(finer, there)
        before = min(over_current(), np.inf if own is None else own.score)
        farther = again is not None and again.score < before - budget.part_of_missing_promise * missing
        return (finer, there, again) if farther else (candidate, simulator, own)

    def at_card(candidate: Candidate, simulator: Simulator, own: Hypothesis | None) -> Tried:
        """Its trial from where the user began, start states too, if it comes farther so: from a bent fit's no refit leads back."""
        if not candidate.at_card:
            return candidate, simulator, own
        there = replace(candidate, starts=candidate.at_card, from_motion=(), at_card=(), begun=study.at_card[0])
        again = tried(there, simulator)
        farther = again is not None and (own is None or again.score < own.score)
        return (there, simulator, again) if farther else (candidate, simulator, own)

    all_tried = side_by_side(partial(at_card, *pair, own) for pair, own in zip(pairs, reached, strict=True))
    all_tried = side_by_side(partial(in_finer_steps, *one) for one in all_tried)
    pairs, reached = [(one, simulator) for one, simulator, _ in all_tried], [own for *_, own in all_tried]
    over_middle = [next(iter(compared(own, middle)), None) for own in reached]
    shown = side_by_side(partial(where_it_shows, *pair, own) for pair, own in zip(pairs, over_middle, strict=True))
    rounds = _finalists_of(study, shown, pairs)
    if others := {one[2] for one in shown if one is not None} - {middle}:
        shown = side_by_side(partial(where_others_show, *pair, own) for pair, own in zip(pairs, shown, strict=True))
        rounds = _both(_finalists_of(study, shown, pairs), _finalists_of(study, over_middle, pairs))
    final: list[RankedCandidate] = []
    for some in rounds:
        if any(_pays(study, r) for r in final):
            break
        # Curves take longest: begun last, they would leave the other cores idle.
        longest_first = sorted(some, key=lambda entry: not entry[1].unknown)
        final += [r for r in side_by_side(partial(in_full, *entry[1:]) for entry in longest_first) if r is not None]
    return in_order([*final, *laws_behind_curve(study, current, final, frozen)], study.settings)


def _missing_of_promise(study: Study, candidate: Candidate, before: float, own: Hypothesis | None) -> float | None:
    """What dry friction lacks of what the screen promises (logarithms of the error), where that is much of it; else None.

    Its steps may be too long: where it holds a light body its tangents grow from step to step, and no refit moves.
    """
    if not candidate.attachment.mechanism.rubs or candidate.explained < study.budget.promise_of_dry_friction:
        return None
    promised = -float(np.log1p(-min(candidate.explained, MOST_PROMISED)))
    missing = promised if own is None else promised - max(before - own.score, 0.0)
    return missing if missing > study.budget.most_of_promise_missing * promised else None


def _finalists_of(
    study: Study, shown: Sequence[Shown | None], pairs: Sequence[tuple[Candidate, Simulator]]
) -> list[list[Trial]]:
    """The finalists among those that were shown: those that lead, and the rest."""
    known = zip(shown, pairs, strict=True)
    trials = [(one[0], candidate, one[1], simulator) for one, (candidate, simulator) in known if one is not None]
    return leading_and_rest(study, finalists(in_better_order(trials), study))


def _both(over_longer: list[list[Trial]], over_middle: list[list[Trial]]) -> list[list[Trial]]:
    """What leads over windows of either kind, then the rest of both, each law once.

    Gains over longer windows are not those over middle ones. Seen: a pendulum's friction led over middle windows; beside others over
    longer ones it was no finalist.
    """
    there: set[tuple] = set()
    rounds: list[list[Trial]] = []
    for some in zip(over_longer, over_middle, strict=True):
        # Of a law in both at once, the trial over longer windows stands.
        entries = {identity_of(e[1].attachment): e for e in (*some[1], *some[0])}
        rounds.append([e for identity, e in entries.items() if identity not in there])
        there |= set(entries)
    return rounds


def _elsewhere(study: Study, candidate: Candidate, trial: Hypothesis) -> list[dict[str, float]]:
    """Where the law says that a refit may begin once more after its trial."""
    effect, values = candidate.attachment, trial.values()
    others = effect.mechanism.begun_elsewhere(study.surroundings[effect.port], effect.own(trial.values()))
    return [{**values, **{f"{effect.prefix}.{n}": v for n, v in other.items()}} for other in others]


def _score_over(fitted: Hypothesis, steps: int) -> float:
    """The score over windows of one length, in steps."""
    return score_of([f for f in fitted.fits if f.windows.steps == steps], fitted.floor) + fitted.implausible


def _pays(study: Study, ranked: RankedCandidate) -> bool:
    """Whether a named candidate improves on the hypothesis before it, surely, and by a law that says something of the machine."""
    settings = study.settings
    improves = ranked.gain > settings.least_gain and ranked.significance > settings.least_significance
    return improves and not ranked.unknown and sound(study, ranked)


def _held(candidate: Candidate, heights: frozenset[str]) -> frozenset[str]:
    """What keeps its value while a candidate is ranked: the heights of a curve, which are many, and good already but for a gain.

    With another gain all forces are others. Seen: the gain of a wheel's torque beside a curve of the pivot, which without the curve's scale
    was no rival of the gain of the wheel's sensor (0.97); they differ by one factor of all forces.
    """
    return frozenset() if candidate.attachment.mechanism.scales else heights


def _compiled(study: Study, current: Hypothesis, found: Sequence[Candidate], frozen: frozenset[str]) -> list[Simulator]:
    """Simulators of the whole shortlist, compiled side by side."""

    def build(candidate: Candidate) -> Simulator:
        model = augmented(study.problem, joined(current.effects, candidate), study.surroundings)
        free = without_free(problem_for(study.problem, model, {}), _held(candidate, frozen)).free_names
        return current.simulator.for_model(model, free)

    return side_by_side(partial(build, candidate) for candidate in found)
