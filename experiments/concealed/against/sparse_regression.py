"""Residual regression in the manner of SINDy: which few terms, of a library, are the force that the model lacks?

For every port the missing force is smoothed out of the recordings (:mod:`.residual_force`) and regressed on the library by pysindy's
sequentially thresholded least squares, on the first part of the estimation experiments, beside what the model's own parameters can do
there already (:mod:`.own_terms`); threshold and smoothness are those that predict the
missing force of the last part with the fewest terms. The plain model was tuned without these terms and its parameters lie: added as they
are, the right terms often make it worse. So every port's terms are re-estimated jointly with the parameters on the first part, which is
more than SINDy does, and ports are a contest of errors on the last: the answer is the best one, if it beats the plain model there. Its free
run is judged twice, with coefficients as regressed and with everything re-estimated on whole records.

What it cannot see: one output lets one missing force at a time be reconstructed, so two effects at two ports are beyond it; and whatever
has a memory is no function of the signals that are there.

Source: S. L. Brunton, J. L. Proctor, J. N. Kutz, "Discovering governing equations from data by sparse identification of nonlinear
dynamical systems", PNAS 113(15), 2016; A. A. Kaptanoglu et al., "PySINDy", Journal of Open Source Software 7(69), 2022.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from experiments.concealed.against.judge import Answer
from experiments.concealed.against.own_terms import own_columns
from experiments.concealed.against.plain import CHOSEN_ON, Plain
from experiments.concealed.against.residual_force import Smoother
from experiments.concealed.against.sparse_fit import Sparse, named, regress
from experiments.concealed.against.sparse_terms import SparseTerms, columns, extended
from experiments.concealed.against.terms import terms
from greybox_torch import NumericalError
from greybox_torch.diagnosis.hypothesis import Hypothesis, finish, hypothesis, window_lengths
from greybox_torch.estimate import problem_for
from greybox_torch.mechanisms import Attachment, attach

WANDER = (30.0, 1000.0)
"""Samples after which the missing force may have become as large as the forces that are there."""

SPARSER = 0.05
"""What share of the missing force's mean square fewer terms may cost."""

LEAST = 0.05
"""What share of the missing force's mean square terms must predict on data they were not fitted to."""

WORTH = 0.9
"""What share of the plain model's held-out error an answer may leave at most."""

TIED = 0.9
"""Of ports that leave nearly the same error, the one with the fewest terms is the answer."""


@dataclass(frozen=True)
class Entry:
    """A port's terms in the contest: coefficients (n,) re-estimated on the first part, and the mean squared error on the last."""

    sparse: Sparse
    fitted: Hypothesis
    coefficients: np.ndarray
    left: float

    @property
    def said(self) -> tuple[str, ...]:
        return named(self.sparse.terms, self.coefficients, self.sparse.gram)


def sparse_regression(plain: Plain) -> tuple[Answer, Answer]:
    """The answers of the regression: with coefficients as regressed, and with everything re-estimated.

    Raises:
        NumericalError: the plain model overflows over the windows of the first part.
    """
    alone = _estimated(plain, ())
    if alone is None:
        raise NumericalError(
            f"{plain.data.path}: the plain model overflows over {plain.length} samples; try other start values"
        )
    before = _left(plain, alone)
    entries = [e for sparse in _regressed(plain) if (e := _entered(plain, sparse)) is not None]
    notes = {
        "held_out_plain": before,
        "contest": [
            {
                "port": e.sparse.port,
                "terms": [t.name for t in e.sparse.terms],
                "predicted": e.sparse.predicted,
                "held_out": e.left,
                "said": e.said,
            }
            for e in entries
        ],
    }
    least = min((e.left for e in entries), default=np.inf)
    if not least < WORTH * before:
        nothing = Answer(plain.problem.model, plain.problem.values_by_name, (), notes)
        return nothing, nothing
    best = min((e for e in entries if TIED * e.left <= least), key=lambda e: (len(e.sparse.terms), e.left))
    names = [(best.sparse.port, name) for name in best.said]
    as_regressed = problem_for(plain.problem, best.fitted.model, {}).values_by_name
    return (
        Answer(best.fitted.model, as_regressed, names, notes),
        Answer(best.fitted.model, _on_records(plain, best), names, notes),
    )


def _regressed(plain: Plain) -> Iterator[Sparse]:
    """The terms of every port that predict some of what it lacks."""
    for port in plain.problem.model.all_ports:
        if port.kind == "sensor":
            continue  # a force alone cannot change what is measured at once
        smoother = Smoother(plain, port.name)
        begin = smoother.start()
        library = terms(port.kind, plain.surroundings[port.name])
        model, attachment = extended(plain.problem.model, port.name, SparseTerms(library), plain.surroundings)
        found: list[Sparse] = []
        for wander in WANDER:
            smoothed = smoother.run(begin, wander)
            table = columns(plain.problem, model, attachment, smoothed.states)
            own = own_columns(plain.problem, port.name, smoothed.states)
            found += regress(port.name, library, table, own, smoothed.force, split(plain))
        best = max((s.predicted for s in found), default=-np.inf)
        if best > LEAST:
            yield min((s for s in found if s.predicted >= best - SPARSER), key=lambda s: (len(s.terms), -s.predicted))


def _entered(plain: Plain, sparse: Sparse) -> Entry | None:
    law = SparseTerms(sparse.terms, [float(c) for c in sparse.coefficients])
    attachment = attach(plain.problem.model, sparse.port, law)
    fitted = _estimated(plain, (attachment,))
    if fitted is None:
        return None
    values = fitted.values()
    coefficients = np.array([values[f"{attachment.prefix}.w_{i}"] for i in range(len(sparse.terms))])
    return Entry(sparse, fitted, coefficients, _left(plain, fitted))


def _estimated(plain: Plain, effects: Sequence[Attachment]) -> Hypothesis | None:
    """The model with ``effects``, everything estimated over windows of the first part; None where these overflow."""
    records, stop = plain.problem.records, split(plain)
    spans = [
        slice(int(f), min(int(f + n), stop)) for f, n in zip(records.first, records.lengths, strict=True) if f < stop
    ]
    part = replace(
        plain.problem,
        records=records.part(spans, records.names[: len(spans)]),
        initial=plain.problem.initial[: len(spans)],
    )
    at = window_lengths(plain.problem)[:2]
    return hypothesis(part, effects, plain.surroundings, [{}], options=plain.simulator.options, at=at)


def _left(plain: Plain, fitted: Hypothesis) -> float:
    """Mean squared error over the windows of the last part, start states free, parameters as fitted on the first."""
    again = hypothesis(
        plain.problem,
        fitted.effects,
        plain.surroundings,
        [fitted.values()],
        options=plain.simulator.options,
        at=window_lengths(plain.problem)[:2],
        frozen=frozenset(fitted.problem.names),
    )
    if again is None:
        return float("inf")
    last = again.fits[-1]
    held_out = last.windows.start >= split(plain)
    return float(last.energies[held_out].sum()) / max(int(held_out.sum()) * last.windows.steps, 1)


def _on_records(plain: Plain, entry: Entry) -> dict[str, float]:
    """Coefficients and parameters estimated together on whole records."""
    whole = hypothesis(
        plain.problem,
        entry.fitted.effects,
        plain.surroundings,
        [entry.fitted.values()],
        options=plain.simulator.options,
    )
    return (entry.fitted if whole is None else finish(whole)).values()


def split(plain: Plain) -> int:
    """The sample of the records at which the last part of the estimation experiments begins."""
    return int((1.0 - CHOSEN_ON) * plain.problem.records.u.shape[1])
