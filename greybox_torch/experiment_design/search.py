"""The search for the input: draws at random, then small changes of the best; whatever leaves the limits is made smaller or dropped."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from greybox_torch.experiment_design.aim import Aim, Candidate, Trial
from greybox_torch.experiment_design.approach import begun_there
from greybox_torch.experiment_design.excitation import drawn, varied
from greybox_torch.experiment_design.imitation import THOROUGH
from greybox_torch.experiment_design.judged import Draws, draws_of, judged
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.experiment_design.simulated import chunks, predictions, within

MOST_SAMPLES = 20_000
"""A longer recording is designed for so many samples: what it tells grows in proportion to its length."""

DRAWN, KEPT, VARIED, GENERATIONS = 96, 6, 24, 3
SHORTEST = 1000
"""Samples of the shortest recording whose best inputs a longer one begins with; the next is twice as long."""
SMALLER = (1.0, 0.5, 0.25, 0.1, 0.03)
"""Factors on the amplitude that are tried until a candidate stays within the limits."""

MOST_TRIED = 200_000
"""Samples of all inputs that are drawn, at most: of a recording of 20 000 samples a tenth as many are tried as of one of 2 000."""

JUDGED, FINALISTS = 8, 2
"""Inputs of a generation, and of the last one, that have their rivals estimated anew, at most."""
MOST_WORK = 300_000
"""Samples times pairs of hypotheses, over all inputs that are judged so: seconds. Of long recordings, one in a generation."""


def search(aim: Aim, limits: Limits, time: np.ndarray, seed: int, progress: Callable[[str], None]) -> list[Trial]:
    """The best inputs found, the best first; empty where none stays within the limits.

    Where a parameter is to be sharpened, the best of shorter recordings, continued, are among the inputs that a longer one begins with:
    fewer are tried of a longer one, and more time would promise less.

    Args:
        time: of the samples (N,), s.
        progress: is told what is being done.
    """
    begun: list[Candidate] = []
    if aim.parameter is not None:
        for samples in shorter(len(time)):
            begun = [trial.candidate for trial in _searched(aim, limits, time[:samples], seed, progress, begun)]
    return _searched(aim, limits, time, seed, progress, begun)


def shorter(samples: int) -> list[int]:
    """The lengths that are searched before one of so many ``samples``: the same ones for all, so that any two have them in common."""
    found, length = [], SHORTEST
    while length < samples:
        found.append(length)
        length *= 2
    return found


def _searched(
    aim: Aim,
    limits: Limits,
    time: np.ndarray,
    seed: int,
    progress: Callable[[str], None],
    begun: Sequence[Candidate],
) -> list[Trial]:
    """The best inputs of one length, the best first, of those ``begun`` with and others drawn."""
    rng = np.random.default_rng(seed)
    slowest, fastest = frequencies(time)
    count = len(limits.commanded)
    tried, again = tries(len(time))
    first = [*begun, *(tuple(drawn(rng, slowest, fastest) for _ in range(count)) for _ in range(tried))]
    progress(f"simulating {len(first)} inputs of {time[-1] - time[0] + time[1] - time[0]:.3g} s")
    draws = draws_of(aim, seed) if aim.parameter is None else None
    best = _best(aim, limits, time, _tried(aim, limits, time, first), draws)
    for generation in range(GENERATIONS if best else 0):
        progress(f"refining the best inputs, {generation + 1} of {GENERATIONS}")
        of = [best[k % len(best)].candidate for k in range(again)]
        changed = [tuple(varied(e, rng, slowest, fastest) for e in candidate) for candidate in of]
        best = _best(aim, limits, time, [*best, *_tried(aim, limits, time, changed)], draws)
    if draws is None:
        return best
    progress("estimating the rivals anew on the best inputs")
    count = int(np.clip(_work(aim, time), 1, FINALISTS))
    return sorted((judged(aim, draws, t, time, limits, THOROUGH) for t in best[:count]), key=_badness)


def tries(samples: int) -> tuple[int, int]:
    """How many inputs are drawn, and how many are varied in a generation: fewer of long recordings."""
    tried = int(np.clip(MOST_TRIED // samples, 2 * KEPT, DRAWN))
    return tried, max(KEPT, tried * VARIED // DRAWN)


def _work(aim: Aim, time: np.ndarray) -> int:
    """How many inputs of a generation may be judged with their rivals estimated anew."""
    return MOST_WORK // (len(time) * len(aim.contenders) ** 2 * (GENERATIONS + 1))


def _best(aim: Aim, limits: Limits, time: np.ndarray, trials: Sequence[Trial], draws: Draws | None) -> list[Trial]:
    """The trials to keep: by what rivals cannot imitate where they are linear, the best of them judged by what they really cannot."""
    ranked = sorted(trials, key=_badness)
    if draws is None:
        return ranked[:KEPT]
    left = int(np.clip(_work(aim, time), 1, JUDGED))
    while left > 0 and any(t.nats is None for t in ranked[:KEPT]):
        first = next(k for k, t in enumerate(ranked) if t.nats is None)
        ranked[first] = judged(aim, draws, ranked[first], time, limits)
        ranked.sort(key=_badness)
        left -= 1
    sure = [t for t in ranked if t.nats is not None]
    return sure[:KEPT]


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
        commands = [sampled(candidate, time, limits) for candidate in smaller]
        fine = within(aim.contenders, limits, commands, time)
        ready += [(c, u) for c, u, ok in zip(smaller, commands, fine, strict=True) if ok]
        left = [c for c, ok in zip(left, fine, strict=True) if not ok]
        if not left:
            break
    scores = _scores(aim, [u for _, u in ready], time)
    trials = [Trial(c, u, s) for (c, u), s in zip(ready, scores, strict=True)]
    return [t for t in trials if np.isfinite(t.score)]


def sampled(candidate: Candidate, time: np.ndarray, limits: Limits) -> np.ndarray:
    """What is commanded with a candidate, (n_u, N)."""
    return begun_there(
        np.array([e.sampled(time, w) for e, w in zip(candidate, limits.commanded.values(), strict=True)]), time, limits
    )


def _scores(aim: Aim, commands: Sequence[np.ndarray], time: np.ndarray) -> list[float]:
    scores: list[float] = []
    largest = max(len(c.free) + int(c.problem.initial_free.sum()) for c in aim.contenders)
    for chunk in chunks(len(commands), len(time) * len(aim.level) * largest):
        along = predictions(aim.contenders, commands[chunk], time)
        for k in range(len(commands[chunk])):
            found = [one for right in along for one in right]
            sound = all(f.slopes is not None and np.isfinite(f.slopes[k]).all() for f in found)
            scores.append(aim.score(along, k) if sound else -np.inf)
    return scores
