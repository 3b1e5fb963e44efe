"""One round of the search: screen, refit the shortlist, compare them fairly, take the best if it pays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from greybox_torch.diagnosis.hypothesis.fit import POLISH_SETTINGS, WINDOW_SETTINGS, Hypothesis, hypothesis
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.refit.curve import finer
from greybox_torch.diagnosis.refit.rank import MOST_TIED, TIE, RankedCandidate, in_order, judged, polished, rank
from greybox_torch.diagnosis.refit.restarts import restarts
from greybox_torch.diagnosis.refit.ties import rank_by_likelihood
from greybox_torch.diagnosis.screen.candidates import candidates, periodic_candidates
from greybox_torch.diagnosis.screen.periodic_orders import distinct_orders, scan_orders
from greybox_torch.diagnosis.screen.score_test import Screen, ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate, elsewhere, shortlist
from greybox_torch.diagnosis.select.choice import CURVE_MARGIN, LEAST_GAIN, LEAST_SIGNIFICANCE, chosen, least_gain
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.shifted_states import shifted_states
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.estimate.window_fit import states_along
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.side_by_side import side_by_side

FINE_KNOTS = 40
"""Knots of the curves that are tried when nothing else pays."""

MOST_PARAMETERS = 70
"""Free parameters of a hypothesis, beyond which its curve is not drawn any finer."""

CLOSE = 0.7
"""Share of the best gain from which a rival is polished before it is compared."""

FRONT_RUNNERS = 3
LEAST_PART = 0.02
"""Share of the plain model's mean squared error that a free curve has to remove at some window length."""

HOPE = 0.5
"""Share of that which a curve must promise in the screen to be refitted at all."""

LEAST_BY_FINE_CURVE = 0.3
"""Share of what named effects leave that a fine curve has to promise in the screen: forty knots always take up something."""

LEAST_BESIDE_CURVE = 0.1
"""Share of what a free curve leaves from which a further effect is worth refits, which are slow beside it."""


@dataclass(frozen=True)
class Round:
    """One round of the search: what the screen saw, the hypothesis that was built on, what the refits said, and which of them was taken
    (None: nothing).
    """

    looks: tuple[tuple[ScreenScore, ...], ...]
    parent: Hypothesis
    ranked: tuple[RankedCandidate, ...]
    taken: RankedCandidate | None


@dataclass
class Rounds:
    """A hypothesis and the rounds that led to it: what a search is made of.

    ``plain`` is the model without effects, ``current`` the hypothesis so far, ``shifts`` and ``surroundings`` what mechanisms need to
    know of the ports; all are there after :meth:`begin`.
    """

    problem: Problem
    substeps: int
    device: str = "cpu"
    progress: Callable[[str], None] = lambda text: None
    rounds: list[Round] = field(default_factory=list)
    curves: bool = True

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
        # Over windows, not along the free run: that runs through a stop that the model lacks, and away with a bias.
        over = plain.fits[min(1, len(plain.fits) - 1)]
        visited = states_along(over, plain.stepper, self.substeps)
        self.surroundings: dict[str, Surroundings] = surroundings_along(self.problem.model, over.problem, visited)

    def round_of(self, prefix: str) -> Round | None:
        """The round in which an effect was taken, the last one where it was chosen anew beside the others."""
        return next(
            (r for r in reversed(self.rounds) if r.taken is not None and r.taken.leader.attachment.prefix == prefix),
            None,
        )

    def step(self, *, fine: bool = False) -> bool:
        """One round: screen, refit the shortlist, take the best if it pays. Whether one was taken.

        Args:
            fine: look at curves with many knots, and at nothing else.
        """
        looks = self._screened(fine=fine)
        found = shortlist(looks, self.current.fits, self.surroundings, self._card())
        least = (
            LEAST_BY_FINE_CURVE if fine and self.current.effects else LEAST_BESIDE_CURVE if self._has_curve() else 0.0
        )
        found = [k for k in found if k.explained >= least]
        found = [k for k in found if not k.unknown or self._promising(k)]
        ranked = self._ranked(found)
        return self._take(looks, in_order([*ranked, *self._ranked(self._elsewhere(looks, found, ranked))]))

    def _ranked(self, found: Sequence[Candidate]) -> list[RankedCandidate]:
        return rank(
            self.problem,
            self.current,
            found,
            self.surroundings,
            substeps=self.substeps,
            device=self.device,
            progress=self.progress,
        )

    def _elsewhere(
        self, looks: Sequence[Sequence[ScreenScore]], found: Sequence[Candidate], ranked: Sequence[RankedCandidate]
    ) -> list[Candidate]:
        """The best named law at the ports where the screen did not put it among the first, if it pays."""
        best = next((r for r in ranked if not r.unknown), None)
        if best is None or best.gain < least_gain(best.fitted) or best.significance < LEAST_SIGNIFICANCE:
            return []
        known = [k.attachment for k in found]
        return elsewhere(best.leader.attachment, known, looks, self.current.fits, self.surroundings, self._card())

    def _take(self, looks: Sequence[Sequence[ScreenScore]], ranked: Sequence[RankedCandidate]) -> bool:
        """End a round: compare what was refitted fairly, and take the best if it pays. Whether one was taken."""
        ranked = rank_by_likelihood(self._fairly(looks, ranked), self.substeps, device=self.device)
        paying = (r for r in ranked if r.gain > least_gain(r.fitted) and r.significance > LEAST_SIGNIFICANCE)
        taken = chosen([r for r in paying if not r.unknown or self._substantial(r)])
        self.rounds.append(Round(tuple(tuple(at) for at in looks), self.current, tuple(ranked), taken))
        if taken is not None:
            self.current = self._detailed(taken) if taken.unknown else taken.fitted
        return taken is not None

    def _promising(self, curve: Candidate) -> bool:
        """Whether the screen leaves hope that a free curve is substantial: its refits are the slowest of all."""
        left = (c.mean_square / p.mean_square for p, c in zip(self.plain.fits, self.current.fits, strict=True))
        return curve.explained * max(left) > HOPE * LEAST_PART

    def _substantial(self, curve: RankedCandidate) -> bool:
        """Whether a free curve explains a part of the whole mismatch that counts, and not what a named law lacks to be the machine's.

        By less than the margin it would give way to names, or to nothing where no name pays.
        """
        fits = zip(self.plain.fits, self.current.fits, curve.fitted.fits, strict=True)
        return curve.gain > CURVE_MARGIN and any(
            b.mean_square - a.mean_square > LEAST_PART * p.mean_square for p, b, a in fits
        )

    def _detailed(self, taken: RankedCandidate) -> Hypothesis:
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

    def _may_be_a_curve(self) -> bool:
        """Whether free curves are offered: one says that something is unknown, and where; a second one would only fit what is left."""
        return self.curves and not self._has_curve()

    def _has_curve(self) -> bool:
        return any(isinstance(e.mechanism, Unknown) for e in self.current.effects)

    def _screened(self, *, fine: bool) -> list[list[ScreenScore]]:
        self.progress("screening fine curves" if fine else "screening every port and mechanism")
        offered = self._fine_curves() if fine else self._offered()
        model, at, free = self.problem.model, self.current, self.current.problem.free_names
        there = {(e.port, e.mechanism.name) for e in at.effects}
        there_in_part = {(e.port, name) for e in at.effects for name in e.mechanism.includes}
        offered = [
            a
            for a in offered
            if not there & {(a.port, n) for n in (a.mechanism.name, *a.mechanism.generalises)}
            and (a.port, a.mechanism.name) not in there_in_part
        ]
        screen = Screen.of(model, at.effects, offered, self.surroundings, free, device=self.device)
        return side_by_side(partial(screen.look, fit, self.substeps) for fit in at.fits)

    def _fine_curves(self) -> list[Attachment]:
        return candidates(self.problem.model, self.shifts, self.surroundings, flexible=True, knots=FINE_KNOTS)

    def _offered(self) -> list[Attachment]:
        model, at, free = self.problem.model, self.current, self.current.problem.free_names
        over = [f for f in at.fits if f.mean_square > noise_floor(self.problem)] or at.fits
        orders = scan_orders(
            model, at.effects, self.surroundings, free, over[:2], substeps=self.substeps, device=self.device
        )
        orders = distinct_orders([*orders, *self._orders_before()])
        return [
            *candidates(model, self.shifts, self.surroundings, flexible=False),
            *periodic_candidates(model, self.shifts, self.surroundings, orders),
            *(candidates(model, self.shifts, self.surroundings, flexible=True) if self._may_be_a_curve() else []),
        ]

    def _orders_before(self) -> list[float]:
        """Orders that refits of earlier rounds came to: what is there now may hide the one that is right from a scan."""
        ranked = [r for done in self.rounds for r in done.ranked if r.gain > LEAST_GAIN]
        values = ((r.fitted.values(), f"{r.leader.attachment.prefix}.order") for r in ranked)
        return [found[name] for found, name in values if name in found]

    def _fairly(
        self, looks: Sequence[Sequence[ScreenScore]], ranked: Sequence[RankedCandidate]
    ) -> list[RankedCandidate]:
        """The front runners polished, and compared with their parent refitted from the best one's values.

        Without the first, the order among close rivals would be the luck of their start values; without the second, an effect of next
        to no size could win merely because its refit got out of a local minimum that the parent sits in.
        """
        if not ranked or ranked[0].gain < LEAST_GAIN:
            return list(ranked)
        tied = sum(not r.unknown and r.gain > ranked[0].gain - TIE for r in ranked)
        # Not always the first of the ranking: that has a price for every parameter.
        close = [r for r in ranked if r.gain > CLOSE * ranked[0].gain]
        front = close[: max(FRONT_RUNNERS, min(tied, MOST_TIED))]
        polish = side_by_side(
            partial(self._polished, r.fitted, restarts(looks, r, self._card(), self.surroundings)) for r in front
        )
        best = min(polish, key=lambda fitted: fitted.score)
        parent = self._polished(self.current, [best.values(), {**best.values(), **self._card()}])
        if parent.score < self.current.score:
            self.current = parent
            if not parent.effects:
                self.plain = parent
        rest = [r for r in ranked if all(r is not one for one in front)]
        fitted = [*polish, *(r.fitted for r in rest)]
        return in_order([judged(r.leader, self.current, one) for r, one in zip([*front, *rest], fitted, strict=True)])

    def _polished(self, fitted: Hypothesis, starts: Sequence[dict[str, float]]) -> Hypothesis:
        self.progress(f"polishing {' + '.join(e.prefix for e in fitted.effects) or 'the model as it stands'}")
        return polished(self.problem, fitted, self.surroundings, starts, substeps=self.substeps, device=self.device)

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


def _knots(curve: Attachment) -> int:
    assert isinstance(curve.mechanism, Unknown)
    return curve.mechanism.knots
