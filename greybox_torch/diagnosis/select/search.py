"""Which effects the data ask for: one at a time while it pays, then each tried without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import ABOVE_NOISE, only_noise, times_noise
from greybox_torch.diagnosis.hypothesis.significance import significance
from greybox_torch.diagnosis.refit.curve import absorbed
from greybox_torch.diagnosis.refit.rank import PARSIMONY, RankedCandidate
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate, shortlist
from greybox_torch.diagnosis.select.choice import (
    CURVE_MARGIN,
    LEAST_GAIN,
    LEAST_SIGNIFICANCE,
    alone_at_noise,
    least_gain,
)
from greybox_torch.diagnosis.select.forward_step import Round, Rounds
from greybox_torch.diagnosis.select.posterior import shared
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.simulation.side_by_side import side_by_side

MOST_EFFECTS = 4
MOST_REVISIONS = 2

BEYOND_DOUBT = 0.95
"""Probability from which an effect is not chosen once more when others have been found."""

NAMED_SHARE = 0.85
"""Share of a free curve's gain (in the logarithm of the mean squared error) from which named effects stand for it: real friction is
never exactly the law of a book."""

LEAST_SHARE_PASSED_OVER = 0.5
"""Share of the residual over the shortest windows from which what explains it is followed, whatever longer ones say."""


@dataclass
class Search(Rounds):
    """The search for effects that a problem's data ask for, beyond its model.

    Use: ``search = Search(problem, substeps); search.run()``; then ``search.current`` is the final hypothesis, ``search.plain`` the
    model without effects, ``search.rounds`` how it came about.
    """

    without: dict[str, Hypothesis] = field(default_factory=dict)
    named: tuple[Hypothesis, list[Round]] | None = None
    """Named effects found in the place of a free curve that goes farther, and the rounds that led to them."""

    def run(self) -> Hypothesis:
        """Search until nothing pays any more."""
        if not hasattr(self, "plain"):
            self.begin()
        self._explore()
        self.prune()
        for _ in range(MOST_REVISIONS):
            if not self._revised():
                break
            self._advance()
            self.prune()
        return self.current

    def _explore(self) -> None:
        """Take effects while it pays; where the first choice passed over what explains short windows, also from there: the better result.

        Two effects that need one another show over short windows, where start states take up what is slow; over long ones neither of
        them helps alone, and something that is not there may do better than either.
        """
        before, kept = self.current, list(self.rounds)
        self._advance()
        passed_over = self._passed_over(before, self.rounds[len(kept)]) if len(self.rounds) > len(kept) else None
        if passed_over is None or passed_over.attachment.prefix in {e.prefix for e in self.current.effects}:
            return
        first_way = self.current, self.rounds
        if not self._advance_from(passed_over, before, kept) or self._cost() > self._cost(first_way[0]) - CURVE_MARGIN:
            self.current, self.rounds = first_way

    def _advance_from(self, leader: Candidate, before: Hypothesis, kept: list[Round]) -> bool:
        """Search on from ``before`` with an effect given, which is then chosen once more beside the others; whether it was."""
        given = self._refitted((*before.effects, leader.attachment), before, leader.starts)
        if given is None:
            return False
        self.current, self.rounds = given, list(kept)
        self._advance()
        others, reached = list(self.rounds[len(kept) :]), self.current
        rest = tuple(e for e in reached.effects if e is not leader.attachment)
        without = self._refitted(rest, reached) if rest else before
        if without is None:
            return False
        self.current, self.rounds = without, list(kept)
        again = self.step() and not self.rounds[-1].ranked[0].unknown
        self.rounds += [r for r in others if r.taken is not None or r is others[-1]]
        names, others_names = ({e.prefix for e in h.effects} for h in (reached, self.current))
        if again and reached.score < self.current.score and names == others_names:
            self.current = reached
        return again

    def _cost(self, of: Hypothesis | None = None) -> float:
        """Score with a little for every parameter; lower is better."""
        of = of or self.current
        return of.score + PARSIMONY * int(of.problem.free.sum())

    def _passed_over(self, before: Hypothesis, done: Round) -> Candidate | None:
        """The named effect that explains most over the shortest windows, if what was taken explains far less of it."""
        if done.taken is None or done.taken.unknown:
            return None
        shortest = done.looks[0]
        found = [k for k in shortlist(done.looks, before.fits, self.surroundings, self._card()) if not k.unknown]
        shares = {k.attachment.prefix: _explained(shortest, k.attachment) for k in found}
        best = max(found, key=lambda k: shares[k.attachment.prefix], default=None)
        if best is None or shares[best.attachment.prefix] < LEAST_SHARE_PASSED_OVER:
            return None
        taken = _explained(shortest, done.taken.leader.attachment)
        contained = [
            k
            for k in found
            if k.attachment.port == best.attachment.port
            and k.attachment.mechanism.name in best.attachment.mechanism.generalises
        ]
        best = next((k for k in contained if shares[k.attachment.prefix] > 0.9 * shares[best.attachment.prefix]), best)
        return best if taken < 0.5 * shares[best.attachment.prefix] else None

    def _advance(self) -> None:
        """Take effects while it pays."""
        while len(self.current.effects) < MOST_EFFECTS and not only_noise(self.problem, self.current):
            rounds = list(self.rounds)
            if not (self.step() or self._step_with_fine_curves()):
                break
            done = self.rounds[-1]
            if done.taken is not None and done.taken.unknown:
                self._named_instead(done, rounds)
                if len(self.current.effects) == len(done.parent.effects):
                    break  # what is there already comes as far as the curve, and no name goes farther

    def _step_with_fine_curves(self) -> bool:
        """Where nothing pays and yet more than noise is left: one round with curves fine enough for a narrow law."""
        more = times_noise(self.problem, self.current) > ABOVE_NOISE
        return self._may_be_a_curve() and more and self.step(fine=True)

    def _named_instead(self, done: Round, rounds: list[Round]) -> None:
        """Where a free curve was taken: the search without curves from where that round began, kept if named effects come as far.

        One curve can stand for several laws of the same signal, none of which would come near it alone.
        """
        with_curve, its_rounds, before = self.current, self.rounds, done.parent
        self.current, self.rounds, self.curves = before, rounds, False
        try:
            if self._take(done.looks, [r for r in done.ranked if not r.unknown]):
                self._advance()
        except BaseException:  # interrupted: the curve is the best so far
            self.current, self.rounds = with_curve, its_rounds
            raise
        finally:
            self.curves = True
        reached, ceiling = (before.score - h.score for h in (self.current, with_curve))
        share = 1.0 if alone_at_noise(with_curve, self.current) else NAMED_SHARE
        if reached < min(ceiling - CURVE_MARGIN, share * ceiling):
            if len(self.current.effects) > len(before.effects):
                self.named = self.current, self.rounds
            self.current, self.rounds = with_curve, its_rounds

    def settle_for_named(self) -> None:
        """Take the named effects that were found in the place of a free curve."""
        assert self.named is not None
        (self.current, self.rounds), self.named = self.named, None
        self.without = {}
        self.prune()

    def contained(self, effect: Attachment) -> list[tuple[RankedCandidate, Hypothesis]]:
        """Laws that the law of ``effect`` contains, of those that were refitted beside it, and each in its place beside the others."""
        done, found, there = self.round_of(effect.prefix), [], {e.prefix for e in self.current.effects}
        for rival in done.ranked if done is not None else ():
            other = rival.leader.attachment
            inside = other.port == effect.port and other.mechanism.name in effect.mechanism.generalises
            if inside and other.prefix not in there:
                self.progress(f"refitting {other.prefix} in the place of {effect.prefix}")
                effects = tuple(other if e is effect else e for e in self.current.effects)
                fitted = self._refitted(effects, self.current, [rival.fitted.values()])
                found += [] if fitted is None else [(rival, fitted)]
        return found

    def settle_for(self, rival: RankedCandidate, fitted: Hypothesis, effect: Attachment) -> None:
        """Take ``fitted``, with the law of ``rival`` in the place of ``effect``, as if the round had found that."""
        done = self.round_of(effect.prefix)
        self.rounds = [replace(r, taken=rival) if r is done else r for r in self.rounds]
        self.current = fitted
        self.prune()

    def _revised(self) -> bool:
        """Choose doubtful effects but the newest once more, beside the others: an early choice was made while those were still missing.

        Whether one was replaced; the rest is then left as it is.
        """
        for effect in self.current.effects[:-1]:
            if self._beyond_doubt(effect):
                continue
            whole, rounds = self.current, list(self.rounds)
            self.progress(f"choosing {effect.prefix} once more")
            self.current = self.without[effect.prefix]
            try:
                chosen = self.step() and self._cost() < self._cost(whole) + LEAST_GAIN
            finally:
                reached, self.current = self.current, whole
            if not chosen:
                self.rounds = rounds
            elif effect.prefix not in {e.prefix for e in reached.effects}:
                self.current = reached
                self.prune()
                return True
        return False

    def _beyond_doubt(self, effect: Attachment) -> bool:
        """Whether no rival came near an effect in the round that took it."""
        done = self.round_of(effect.prefix)
        return done is not None and done.taken is not None and shared(done.taken, done.ranked)[0] > BEYOND_DOUBT

    def prune(self) -> None:
        """Drop every effect whose loss the rest make up for, until none can go; ``without`` keeps what was compared with."""
        dropped = True
        while dropped:
            dropped = False
            self.without = {}
            effects = self.current.effects
            for effect, rest in zip(effects, side_by_side(partial(self._without, e) for e in effects), strict=True):
                gain = rest.score - self.current.score
                if len(self.current.effects) > 1 and (
                    gain < least_gain(self.current) or significance(rest, self.current) < LEAST_SIGNIFICANCE
                ):
                    self.current, dropped = rest, True
                    break
                self.without[effect.prefix] = rest

    def drop(self, prefix: str) -> None:
        """Take one effect back."""
        self.current = self.without[prefix]
        self.prune()

    def _without(self, effect: Attachment) -> Hypothesis:
        """The current hypothesis refitted without one of its effects."""
        rest = tuple(e for e in self.current.effects if e is not effect)
        if not rest:
            return self.plain
        self.progress(f"trying without {effect.prefix}")
        handed_over = absorbed(self.current, effect, self.surroundings)
        return self._refitted(rest, self.current, [] if handed_over is None else [handed_over]) or self.plain


def _explained(looks: Sequence[ScreenScore], attachment: Attachment) -> float:
    """The most that any look at an effect explains."""
    return max((k.explained for k in looks if k.attachment.prefix == attachment.prefix), default=0.0)
