"""The search for the input: draws at random, then small changes of the best; whatever leaves the limits is made smaller or dropped."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.experiment_design.contender import Contender, Prediction, records_of
from greybox_torch.experiment_design.excitation import Excitation, drawn, varied
from greybox_torch.experiment_design.limits import Limits, Range
from greybox_torch.experiment_design.separation import deviation, evidence
from greybox_torch.simulation.records import Records

MOST_SAMPLES = 20_000
"""A longer recording is designed for so many samples: what it tells grows in proportion to its length."""

DRAWN, KEPT, VARIED, GENERATIONS = 96, 6, 24, 3
SMALLER = (1.0, 0.5, 0.25, 0.1, 0.03)
"""Factors on the amplitude that are tried until a candidate stays within the limits."""

MOST_NUMBERS = 20_000_000
"""Derivatives that are kept at a time."""

Candidate = tuple[Excitation, ...]
"""An excitation for every input."""


@dataclass(frozen=True)
class Aim:
    """What is wanted of a recording, of several hypotheses: evidence between them, or of the first one the deviation of a free parameter.

    ``parameter``: its index among the free ones, None for evidence.
    """

    contenders: tuple[Contender, ...]
    parameter: int | None = None

    @property
    def level(self) -> np.ndarray:
        """Errors (n_y,) in units of which outputs differ, correlated ones counted once: those of the likeliest hypothesis."""
        first = self.contenders[0]
        return first.level * np.sqrt(first.memory)

    def nats(self, predictions: Sequence[Prediction], record: int) -> np.ndarray:
        """The evidence (n, n) of one record for each hypothesis (row) against each other one (column)."""
        count = len(predictions)
        found = np.zeros((count, count))
        for b, rival in enumerate(predictions):
            slopes, known = self._of_rival(b, rival, record)
            for a, right in enumerate(predictions):
                if a != b:
                    difference = ((right.y[record] - rival.y[record]) / self.level).ravel()
                    found[a, b] = evidence(difference, slopes, known)
        return found

    def score(self, predictions: Sequence[Prediction], record: int) -> float:
        """Larger is better: the mean logarithm of the evidence against the nearest rival, or less deviation."""
        if self.parameter is not None:
            slopes, known = self._of_rival(0, predictions[0], record)
            return -float(np.log(deviation(slopes, known, self.parameter)))
        nats = self.nats(predictions, record) + np.diag(np.full(len(predictions), np.inf))
        shares = np.array([c.probability for c in self.contenders])
        return float(shares / shares.sum() @ np.log1p(nats.min(axis=1)))

    def deviation_after(self, prediction: Prediction, record: int) -> float:
        """The standard deviation of the parameter, in its unit."""
        assert self.parameter is not None
        slopes, known = self._of_rival(0, prediction, record)
        return deviation(slopes, known, self.parameter)

    def _of_rival(self, index: int, prediction: Prediction, record: int) -> tuple[np.ndarray, np.ndarray]:
        """Its slopes (N, n_d) in units of the errors, and what is known of its unknowns: nothing of start states."""
        assert prediction.slopes is not None
        slopes = prediction.slopes[record] / self.level[:, None]
        slopes = slopes.reshape(-1, slopes.shape[-1])
        known = np.zeros((slopes.shape[1],) * 2)
        own = self.contenders[index].information
        known[: len(own), : len(own)] = own
        return slopes, known


@dataclass(frozen=True)
class Trial:
    """A candidate within the limits, its input (n_u, N), and how good it is."""

    candidate: Candidate
    inputs: np.ndarray
    score: float


def search(aim: Aim, limits: Limits, time: np.ndarray, seed: int, progress: Callable[[str], None]) -> list[Trial]:
    """The best inputs found, the best first; empty where none stays within the limits.

    Args:
        time: of the samples (N,), s.
        progress: is told what is being done.
    """
    rng = np.random.default_rng(seed)
    slowest, fastest = frequencies(time)
    count = len(limits.inputs)
    begun = [tuple(drawn(rng, slowest, fastest) for _ in range(count)) for _ in range(DRAWN)]
    progress(f"simulating {DRAWN} inputs")
    best = sorted(_tried(aim, limits, time, begun), key=_badness)[:KEPT]
    for generation in range(GENERATIONS if best else 0):
        progress(f"refining the best inputs, {generation + 1} of {GENERATIONS}")
        of = [best[k % len(best)].candidate for k in range(VARIED)]
        changed = [tuple(varied(e, rng, slowest, fastest) for e in candidate) for candidate in of]
        best = sorted([*best, *_tried(aim, limits, time, changed)], key=_badness)[:KEPT]
    return best


def frequencies(time: np.ndarray) -> tuple[float, float]:
    """From one period in the recording to an eighth of the sampling frequency, Hz."""
    span, step = float(time[-1] - time[0]), float(time[1] - time[0])
    return 1.0 / max(span, step), max(0.125 / step, 1.5 / max(span, step))


def _badness(trial: Trial) -> float:
    return -trial.score


def _tried(aim: Aim, limits: Limits, time: np.ndarray, candidates: Sequence[Candidate]) -> list[Trial]:
    """The candidates that can be made small enough for the limits, with their scores."""
    ready: list[tuple[Candidate, np.ndarray]] = []
    left = list(candidates)
    for factor in SMALLER:
        smaller = [tuple(e.smaller(factor) for e in candidate) for candidate in left]
        inputs = [sampled(candidate, time, limits) for candidate in smaller]
        fine = within(aim.contenders, limits, inputs, time)
        ready += [(c, u) for c, u, ok in zip(smaller, inputs, fine, strict=True) if ok]
        left = [c for c, ok in zip(left, fine, strict=True) if not ok]
        if not left:
            break
    scores = _scores(aim, [u for _, u in ready], time)
    trials = [Trial(c, u, s) for (c, u), s in zip(ready, scores, strict=True)]
    return [t for t in trials if np.isfinite(t.score)]


def sampled(candidate: Candidate, time: np.ndarray, limits: Limits) -> np.ndarray:
    """The inputs (n_u, N) of a candidate."""
    return np.array([e.sampled(time, w) for e, w in zip(candidate, limits.inputs.values(), strict=True)])


def within(
    contenders: Sequence[Contender], limits: Limits, inputs: Sequence[np.ndarray], time: np.ndarray
) -> list[bool]:
    """Whether outputs and states stay within the limits under every hypothesis, for each of some inputs."""
    fine = np.ones(len(inputs), dtype=bool)
    for one in contenders:
        for chunk in _chunks(len(inputs), len(time) * (len(one.level) + len(one.problem.model.states))):
            found = one.predicted(_records(one, inputs[chunk], time), tangents=False)
            fine[chunk] &= _inside(found.y, [o.name for o in one.problem.model.outputs], limits.outputs)
            fine[chunk] &= _inside(found.states, [s.name for s in one.problem.model.states], limits.states)
    return [bool(f) for f in fine]


def _inside(values: np.ndarray, names: Sequence[str], limits: Mapping[str, Range]) -> np.ndarray:
    """Whether each record's signals (C, N, n) are finite and within their limits, (C,)."""
    fine: np.ndarray = np.array([np.isfinite(one).all() for one in values])
    for k, name in enumerate(names):
        if name in limits:
            low, high = limits[name].lower, limits[name].upper
            with np.errstate(invalid="ignore"):
                fine &= ((values[..., k] >= low) & (values[..., k] <= high)).all(axis=1)
    return fine


def _scores(aim: Aim, inputs: Sequence[np.ndarray], time: np.ndarray) -> list[float]:
    scores: list[float] = []
    largest = max(len(c.free) + int(c.problem.initial_free.sum()) for c in aim.contenders)
    for chunk in _chunks(len(inputs), len(time) * len(aim.level) * largest):
        found = [one.predicted(_records(one, inputs[chunk], time)) for one in aim.contenders]
        for k in range(len(inputs[chunk])):
            sound = all(f.slopes is not None and np.isfinite(f.slopes[k]).all() for f in found)
            scores.append(aim.score(found, k) if sound else -np.inf)
    return scores


def _records(one: Contender, inputs: Sequence[np.ndarray], time: np.ndarray) -> Records:
    return records_of(inputs, one.problem.records, float(time[1] - time[0]))


def _chunks(count: int, numbers_each: int) -> list[slice]:
    """Slices of at most as many records as keep the memory small."""
    size = max(1, MOST_NUMBERS // max(1, numbers_each))
    return [slice(k, min(k + size, count)) for k in range(0, count, size)]
