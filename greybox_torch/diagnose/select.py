"""Which effects the data ask for: one at a time while it pays, then each tried without."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from greybox_torch.diagnose.candidates import candidates, periodic_candidates, shifted_states
from greybox_torch.diagnose.curve import finer
from greybox_torch.diagnose.leaders import Leader, leaders
from greybox_torch.diagnose.name import PARSIMONY, Ranked, judged, polished, rank, sureness
from greybox_torch.diagnose.noise import ABOVE_NOISE, only_noise, times_noise
from greybox_torch.diagnose.orders import scan_orders
from greybox_torch.diagnose.refit import POLISH_SETTINGS, WINDOW_SETTINGS, Hypothesis, hypothesis
from greybox_torch.diagnose.screen import Look, Screen
from greybox_torch.diagnose.surroundings import survey
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulate.side_by_side import side_by_side

FINE_KNOTS = 40
"""Knots of the curves that are tried when nothing else pays."""

MOST_PARAMETERS = 70
"""Free parameters of a hypothesis, beyond which its curve is not drawn any finer."""

MOST_EFFECTS = 4
MOST_REVISIONS = 2
LEAST_GAIN = 0.01
"""Improvement of the mean squared error (as a share, averaged over window lengths) below which nothing is claimed."""

LEAST_SURENESS = 3.0
"""Standard errors (over windows) by which an effect must improve the prediction."""

CLOSE = 0.7
"""Share of the best gain from which a rival is polished before it is compared."""

FRONT_RUNNERS = 3
MOST_SHAPES = 3

NAMED_SHARE = 0.85
"""Share of a free curve's gain (in the logarithm of the mean squared error) from which named effects stand for it: real friction is
never exactly the law of a book."""

LEAST_SHARE_PASSED_OVER = 0.5
"""Share of the residual over the shortest windows from which what explains it is followed, whatever longer ones say."""

LEAST_PART = 0.02
"""Share of the plain model's mean squared error that a free curve has to remove at some window length."""

LEAST_BESIDE_CURVE = 0.1
"""Share of what a free curve leaves from which a further effect is worth refits, which are slow beside it."""

CURVE_MARGIN = 0.1
"""How much better, in the logarithm of the mean squared error, a free curve must be than every named mechanism to be preferred."""


@dataclass(frozen=True)
class Round:
    """One round of the search: what the screen saw, what the refits said, and which of them was taken (None: nothing)."""

    looks: tuple[tuple[Look, ...], ...]
    ranked: tuple[Ranked, ...]
    taken: Ranked | None


@dataclass
class Search:
    """The search for effects that a problem's data ask for, beyond its model.

    Use: ``search = Search(problem, substeps); search.run()``; then ``search.current`` is the final hypothesis, ``search.plain`` the
    model without effects, ``search.rounds`` how it came about.
    """

    problem: Problem
    substeps: int
    device: str = "cpu"
    progress: Callable[[str], None] = lambda text: None
    rounds: list[Round] = field(default_factory=list)
    without: dict[str, Hypothesis] = field(default_factory=dict)
    curves: bool = True
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

    def _advance_from(self, leader: Leader, before: Hypothesis, kept: list[Round]) -> bool:
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

    def _passed_over(self, before: Hypothesis, done: Round) -> Leader | None:
        """The named effect that explains most over the shortest windows, if what was taken explains far less of it."""
        if done.taken is None or done.taken.unknown:
            return None
        shortest = done.looks[0]
        found = [k for k in leaders(done.looks, before.fits, self.surroundings, self._card()) if not _is_curve(k)]
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
        while len(self.current.effects) < MOST_EFFECTS and not only_noise(self.problem, self.current):
            before, rounds = self.current, list(self.rounds)
            if not (self.step() or self._step_with_fine_curves()):
                break
            taken = self.rounds[-1].taken
            if taken is not None and taken.unknown:
                self._named_instead(before, rounds)

    def _step_with_fine_curves(self) -> bool:
        """Where nothing pays and yet more than noise is left: one round with curves fine enough for a narrow law."""
        more = times_noise(self.problem, self.current) > ABOVE_NOISE
        return self._may_be_a_curve() and more and self.step(fine=True)

    def _may_be_a_curve(self) -> bool:
        """Whether free curves are offered: one says that something is unknown, and where; a second one would only fit what is left."""
        return self.curves and not any(isinstance(e.mechanism, Unknown) for e in self.current.effects)

    def _named_instead(self, before: Hypothesis, rounds: list[Round]) -> None:
        """Where a free curve was taken: the search from ``before`` without curves, kept if named effects come as far.

        One curve can stand for several laws of the same signal, none of which would come near it alone.
        """
        with_curve, its_rounds = self.current, self.rounds
        self.current, self.rounds, self.curves = before, rounds, False
        try:
            self._advance()
        except BaseException:  # interrupted: the curve is the best so far
            self.current, self.rounds = with_curve, its_rounds
            raise
        finally:
            self.curves = True
        reached, ceiling = (before.score - h.score for h in (self.current, with_curve))
        if reached < min(ceiling - CURVE_MARGIN, NAMED_SHARE * ceiling):
            if len(self.current.effects) > len(before.effects):
                self.named = self.current, self.rounds
            self.current, self.rounds = with_curve, its_rounds

    def settle_for_named(self) -> None:
        """Take the named effects that were found in the place of a free curve."""
        assert self.named is not None
        (self.current, self.rounds), self.named = self.named, None
        self.without = {}
        self.prune()

    def _revised(self) -> bool:
        """Choose every one of several effects once more, beside the others: an early choice was made while they were still missing.

        Whether one was replaced; the rest is then left as it is.
        """
        for effect in self.current.effects if len(self.current.effects) > 1 else ():
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

    def begin(self) -> None:
        """Fit the model as it stands.

        Raises:
            NumericalError: it overflows even over short windows.
        """
        self.progress("refitting the model as it stands")
        card = self._card()
        plain = hypothesis(
            self.problem, (), {}, [card], substeps=self.substeps, settings=POLISH_SETTINGS, device=self.device
        )
        if plain is None:
            raise NumericalError(
                f"simulating {self.problem.model.title}: the simulation overflows even over windows of a 64th of the record; "
                "try start values nearer to the truth, or tighter bounds"
            )
        self.plain = self.current = plain
        self.shifts = shifted_states(self.problem.model, plain.problem)
        self.surroundings: dict[str, Surroundings] = survey(
            self.problem.model, plain.problem, plain.stepper, self.substeps
        )

    def step(self, *, fine: bool = False) -> bool:
        """One round: screen, refit the leaders, take the best if it pays. Whether one was taken.

        Args:
            fine: look at curves with many knots, and at nothing else.
        """
        looks = self._screened(fine=fine)
        found = leaders(looks, self.current.fits, self.surroundings, self._card())
        if any(isinstance(e.mechanism, Unknown) for e in self.current.effects):
            found = [k for k in found if k.explained > LEAST_BESIDE_CURVE]
        ranked = rank(
            self.problem,
            self.current,
            found,
            self.surroundings,
            substeps=self.substeps,
            device=self.device,
            progress=self.progress,
        )
        ranked = self._fairly(ranked)
        paying = (r for r in ranked if r.gain > LEAST_GAIN and r.surely > LEAST_SURENESS)
        taken = _chosen([r for r in paying if not r.unknown or self._substantial(r)])
        self.rounds.append(Round(tuple(tuple(at) for at in looks), tuple(ranked), taken))
        if taken is not None:
            self.current = self._detailed(taken) if taken.unknown else taken.fitted
        return taken is not None

    def _substantial(self, curve: Ranked) -> bool:
        """Whether a free curve explains a part of the whole mismatch that counts, and not what a named law lacks to be the machine's."""
        fits = zip(self.plain.fits, self.current.fits, curve.fitted.fits, strict=True)
        return any(b.mean_square - a.mean_square > LEAST_PART * p.mean_square for p, b, a in fits)

    def _detailed(self, taken: Ranked) -> Hypothesis:
        """The hypothesis with its new curve drawn more and more finely, as long as that pays."""
        drawn = taken.fitted
        while len(drawn.problem.free_names) + _knots(drawn.effects[-1]) < MOST_PARAMETERS:
            self.progress("drawing the curve more finely")
            attachment, values = finer(drawn, drawn.effects[-1], self.surroundings)
            fitted = hypothesis(
                self.problem,
                (*drawn.effects[:-1], attachment),
                self.surroundings,
                [values],
                substeps=self.substeps,
                shorter=drawn.fits[0],
                settings=WINDOW_SETTINGS,
                device=self.device,
            )
            if fitted is None or fitted.score > drawn.score - LEAST_GAIN:
                break
            narrow, drawn = fitted.score < drawn.score - CURVE_MARGIN, fitted
            if not narrow:
                break
        return drawn

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
                    gain < LEAST_GAIN or sureness(rest, self.current) < LEAST_SURENESS
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
        return self._refitted(rest, self.current) or self.plain

    def _screened(self, *, fine: bool) -> list[list[Look]]:
        self.progress("screening fine curves" if fine else "screening every port and mechanism")
        offered = self._fine_curves() if fine else self._offered()
        model, at, free = self.problem.model, self.current, self.current.problem.free_names
        there = {(e.port, e.mechanism.name) for e in at.effects}
        offered = [a for a in offered if (a.port, a.mechanism.name) not in there]
        screen = Screen.of(model, at.effects, offered, self.surroundings, free, device=self.device)
        return side_by_side(partial(screen.look, fit, self.substeps) for fit in at.fits)

    def _fine_curves(self) -> list[Attachment]:
        return candidates(self.problem.model, self.shifts, self.surroundings, flexible=True, knots=FINE_KNOTS)

    def _offered(self) -> list[Attachment]:
        model, at, free = self.problem.model, self.current, self.current.problem.free_names
        orders = scan_orders(
            model, at.effects, self.surroundings, free, at.fits[:2], substeps=self.substeps, device=self.device
        )
        return [
            *candidates(model, self.shifts, self.surroundings, flexible=False),
            *periodic_candidates(model, self.shifts, self.surroundings, orders),
            *(candidates(model, self.shifts, self.surroundings, flexible=True) if self._may_be_a_curve() else []),
        ]

    def _fairly(self, ranked: Sequence[Ranked]) -> list[Ranked]:
        """The front runners polished, and compared with their parent refitted from the best one's values.

        Without the first, the order among close rivals would be the luck of their start values; without the second, an effect of next
        to no size could win merely because its refit got out of a local minimum that the parent sits in.
        """
        if not ranked or ranked[0].gain < LEAST_GAIN:
            return list(ranked)
        front = [r for r in ranked if r.gain > CLOSE * ranked[0].gain][:FRONT_RUNNERS]
        polish = side_by_side(partial(self._polished, r.fitted, self._shapes(r)) for r in front)
        best = min(polish, key=lambda fitted: fitted.score)
        parent = self._polished(self.current, [best.values(), {**best.values(), **self._card()}])
        if parent.score < self.current.score:
            self.current = parent
            if not parent.effects:
                self.plain = parent
        rest = [r.fitted for r in ranked[len(front) :]]
        again = [judged(r.leader, self.current, fitted) for r, fitted in zip(ranked, polish + rest, strict=True)]
        return sorted(again, key=lambda r: r.cost)

    def _polished(self, fitted: Hypothesis, starts: Sequence[dict[str, float]]) -> Hypothesis:
        self.progress(f"polishing {' + '.join(e.prefix for e in fitted.effects) or 'the model as it stands'}")
        return polished(self.problem, fitted, self.surroundings, starts, substeps=self.substeps, device=self.device)

    def _shapes(self, ranked: Ranked) -> list[dict[str, float]]:
        """Start values against local minima: the newest effect's shape as each probe of the screen has it, the base's from the card."""
        effect, values = ranked.leader.attachment, ranked.fitted.values()
        card = self._card()
        probes = effect.mechanism.probes(self.surroundings[effect.port])
        shapes = {
            tuple(sorted((f"{effect.prefix}.{n}", v) for n, v in probe.values.items() if n != "order"))
            for probe in probes
        }
        return [{**values, **card, **dict(shape)} for shape in sorted(shapes)[:MOST_SHAPES]]

    def _card(self) -> dict[str, float]:
        """The parameter values that the problem began with."""
        return dict(zip(self.problem.names, map(float, self.problem.values), strict=True))

    def _refitted(
        self, effects: Sequence[Attachment], start: Hypothesis, starts: Sequence[dict[str, float]] = ()
    ) -> Hypothesis | None:
        found = hypothesis(
            self.problem,
            effects,
            self.surroundings,
            [start.values(), {**start.values(), **self._card()}, *starts],
            substeps=self.substeps,
            shorter=start.fits[0],
            settings=POLISH_SETTINGS,
            device=self.device,
        )
        return found


def _simplest(ranked: Sequence[Ranked]) -> Ranked | None:
    """The best, or what it generalises where it is not better than that by more than chance."""
    best = next(iter(ranked), None)
    if best is None:
        return None
    contained = best.leader.attachment.mechanism.generalises
    simpler = (
        r
        for r in ranked
        if r.leader.attachment.mechanism.name in contained and r.leader.attachment.port == best.leader.attachment.port
    )
    return next((r for r in simpler if sureness(r.fitted, best.fitted) < LEAST_SURENESS), best)


def _knots(curve: Attachment) -> int:
    assert isinstance(curve.mechanism, Unknown)
    return curve.mechanism.knots


def _is_curve(leader: Leader) -> bool:
    return isinstance(leader.attachment.mechanism, Unknown)


def _explained(looks: Sequence[Look], attachment: Attachment) -> float:
    """The most that any look at an effect explains."""
    return max((k.explained for k in looks if k.attachment.prefix == attachment.prefix), default=0.0)


def _chosen(ranked: Sequence[Ranked]) -> Ranked | None:
    """The best of the hypotheses that pay: a named mechanism, unless a free curve is better by a margin and takes half again as much."""
    named = _simplest([r for r in ranked if not r.unknown])
    curve = next((r for r in ranked if r.unknown), None)
    if named is None or curve is None:
        return named or curve
    return curve if curve.gain > named.gain + CURVE_MARGIN and curve.gain > 1.5 * named.gain else named
