"""Sparse fits of a missing force by columns of a library, and the mechanisms that the terms which are left speak for."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from experiments.concealed.against.terms import Term

THRESHOLDS = (0.03, 0.1, 0.2, 0.4)
"""Least root mean square of a term, as a share of that of the missing force."""

MOST_TERMS = 12
"""A regression that keeps more terms is not sparse, and is not considered."""

LEFT = 1e-2
"""Least share of a term that what the model can do already must leave, for it to be told from that."""

SPEAKS = 0.5
"""A mechanism is named whose terms carry at least this share of what those of the strongest carry."""


@dataclass(frozen=True)
class Sparse:
    """Terms with coefficients (n,) at a port, and what share of the missing force's mean square they ``predicted`` on the last part.

    ``gram`` (n, n): mean products of the terms, by which the size of what some of them carry is told.
    """

    port: str
    terms: tuple[Term, ...]
    coefficients: np.ndarray
    gram: np.ndarray
    predicted: float


def regress(
    port: str, library: Sequence[Term], table: np.ndarray, own: np.ndarray, force: np.ndarray, stop: int
) -> Iterator[Sparse]:
    """Sparse fits of a missing force (N,) by the columns ``table`` (N, n) over its first ``stop`` samples, one for every threshold.

    What the plain model's own parameters can do (``own`` (N, k), :mod:`.own_terms`), and terms that speak for nothing, are projected out of
    everything before, and left to the parameters. Columns of which little is then left are left out. Coefficients are in units of the force
    per unit of the term.
    """
    from pysindy import STLSQ  # half a second, and a package that only the proof needs

    silent = np.array([not t.positive and not t.negative for t in library])
    nuisance = np.column_stack([own, table[:, silent]])
    both = np.column_stack([table, force])
    first, last = (_without(nuisance[part], both[part]) for part in (slice(stop), slice(stop, None)))
    size, rough = np.sqrt(np.mean(first**2, axis=0)), np.sqrt(np.mean(table[:stop] ** 2, axis=0))
    if not np.isfinite(size).all() or size[-1] <= 1e-12 * float(np.sqrt(np.mean(force[:stop] ** 2))):
        return
    there = np.flatnonzero(~silent & (size[:-1] > LEFT * np.maximum(rough, 1e-300)))
    if not len(there):
        return
    for threshold in THRESHOLDS:
        optimiser = STLSQ(threshold=threshold, alpha=1e-3 * stop)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns where nothing passes the threshold, which is an answer too
            optimiser.fit(first[:, there] / size[there], first[:, -1:] / size[-1])
        weights = np.asarray(optimiser.coef_)[0]
        kept = there[weights != 0.0]
        if 0 < len(kept) <= MOST_TERMS:
            coefficients = weights[weights != 0.0] * size[-1] / size[kept]
            gram = first[:, kept].T @ first[:, kept] / stop
            predicted = _predicted(last[:, kept] @ coefficients, last[:, -1])
            yield Sparse(port, tuple(library[i] for i in kept), coefficients, gram, predicted)


def _without(nuisance: np.ndarray, table: np.ndarray) -> np.ndarray:
    """What a regression on ``nuisance`` (N, k) leaves of each column of ``table`` (N, n)."""
    scale = np.sqrt(np.mean(nuisance**2, axis=0))
    columns = nuisance[:, scale > 0] / scale[scale > 0]
    return table - columns @ np.linalg.lstsq(columns, table, rcond=1e-10)[0] if columns.shape[1] else table


def _predicted(prediction: np.ndarray, force: np.ndarray) -> float:
    """The share of a force's mean square that a prediction explains: a constant force counts like any other."""
    size = float(np.mean(force**2))
    return 1.0 - float(np.mean((force - prediction) ** 2)) / size if size > 0 else -np.inf


def named(chosen: Sequence[Term], coefficients: np.ndarray, gram: np.ndarray) -> tuple[str, ...]:
    """The mechanisms that terms with ``coefficients`` (n,) and mean products ``gram`` (n, n) speak for, the strongest first."""
    said = np.array([t.speaks_for(c) for t, c in zip(chosen, coefficients, strict=True)])
    sizes = {}
    for mechanism in dict.fromkeys(said.tolist()):
        part = np.where(said == mechanism, coefficients, 0.0)
        sizes[mechanism] = float(np.sqrt(max(part @ gram @ part, 0.0)))
    strongest = max(sizes.values())
    return tuple(m for m, size in sorted(sizes.items(), key=lambda pair: -pair[1]) if size >= SPEAKS * strongest)
