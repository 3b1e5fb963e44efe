"""Where the estimation experiments do not show what others do, one of those is taken to choose with as well."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnose.held_out import Others, gain
from greybox_torch.diagnose.noise import far_above_noise, noise_floor
from greybox_torch.diagnose.select import Search
from greybox_torch.estimate.window_fit import WindowFit

SHOWN = 1.5
"""How many times the noise the error of another experiment must be to show what nothing was found of."""

SHOWN_BESIDE, LEFT_BESIDE = 2.0, 0.05
"""The same where something was found, which may be a little wrong and yet right, and the share of the plain model's squared error that it
must leave besides."""


@dataclass(frozen=True)
class Widened:
    """A data set with the experiment ``taken`` among those to choose with, which the model fits ``error`` times the noise."""

    dataset: DataSet
    taken: str
    error: float

    def sentence(self) -> str:
        """What the reader of a verdict has to know of it."""
        return (
            f"{self.taken} was taken to choose with as well, as the model found before leaves {self.error:.2g} times the noise there, "
            "which the estimation experiments do not show so: it no longer counts as validation."
        )


def widened(dataset: DataSet, search: Search, others: Others) -> Widened | None:
    """The data set with the validation experiment that the search's model fits worst among those to choose with.

    None where the others show no more than the estimation experiments do, or where no validation experiment would be left. What has had
    a part in choosing does not score: the experiment changes its role.
    """
    recordings, found = dataset.validation(), bool(search.current.effects)
    if len(recordings) < 2 or (found and far_above_noise(search.current)):
        return None
    squares = _mean_squares(others.fits(search.current), len(recordings))
    errors = np.sqrt(squares / noise_floor(others.problem))
    worst = int(np.argmax(errors))
    if errors[worst] < (SHOWN_BESIDE if found else SHOWN):
        return None
    if found and squares[worst] < LEFT_BESIDE * _mean_squares(others.fits(search.plain), len(recordings))[worst]:
        return None
    name = recordings[worst].name
    changed = tuple(replace(r, role="estimation") if r.name == name else r for r in dataset.recordings)
    return Widened(replace(dataset, recordings=changed), name, float(errors[worst]))


def predicts_better(others: Others, before: Search, after: Search) -> bool:
    """Whether the model of ``after`` predicts the validation experiments that had no part in either better than that of ``before``."""
    return gain(others.fits(before.current), others.fits(after.current)).share > 0


def _mean_squares(fits: tuple[WindowFit, ...], count: int) -> np.ndarray:
    """The largest mean squared weighted errors of fits at several window lengths, by experiment, shape (count,); infinite without fits."""
    return np.max([_mean_squares_of(fit) for fit in fits], axis=0) if fits else np.full(count, np.inf)


def _mean_squares_of(fit: WindowFit) -> np.ndarray:
    tape = fit.problem.tape
    of = np.searchsorted(tape.first, fit.windows.start, side="right") - 1
    known = [int(np.sum(~np.isnan(tape.y[:, tape.span(e)]))) for e in range(len(tape.first))]
    return np.bincount(of, weights=fit.energies, minlength=len(known)) / np.maximum(known, 1)
