"""Whether channels may be exchanged, or one has the other sign: asked where an estimate simulates the validation experiments badly."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnosis.digits import digits
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.comparison import Score, compare, held_out_scores, mean_fit
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.levenberg_marquardt import ROUGH
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.model import GreyBoxModel
from greybox_torch.name_lists import listed
from greybox_torch.simulation.simulator import Simulator

POOR = 80.0
"""Mean fit in % below which it is asked."""

MOST_SAMPLES = 4000
"""Samples of the experiments of a role that it is asked with: the beginnings of all. A hint is worth no more time."""

REFITTED = 3
"""Changes that are refitted, those that simulate best with the start values."""

FAR_BETTER = 0.5
"""Part of what is missing to a fit of 100 % that may be left for a change to be told."""

FOLLOWS = 30.0
"""Mean fit in % that a change has to reach: of free runs that go elsewhere, the one that goes least far says nothing."""

MOST_ALIKE = 28
"""Exchanges among inputs or among outputs that are simulated, and channels of other sign: the pairs of eight. More are not asked for."""

AS_GOOD = 1.2
"""Times as much that others may leave and be told with it."""


FAR_BETTER_SO = "One of these changes makes it far better: the question is asked with the results"
NOTHING_CHANGED = "None of these changes makes it far better: the channels seem to be what the card says"
"""What came of it, in the log."""


@dataclass(frozen=True)
class Change:
    """A channel by which another is read instead, by name, and how a reader is asked; ``sign`` is −1 where that is reversed."""

    read: Mapping[str, str]
    question: str
    sign: float = 1.0

    def of(self, recording: Recording) -> Recording:
        """A recording with the change."""
        changed = {name: self.sign * recording.signals[other] for name, other in self.read.items()}
        return replace(recording, signals={**recording.signals, **changed})


AS_IT_IS = Change({}, "")


def asked_where_poor(
    data: DataSet,
    model: GreyBoxModel,
    refit: Sequence[Score],
    simulator: Callable[[], Simulator],
    progress: Callable[[str], None],
) -> str | None:
    """The question of :func:`exchanged`, where the re-estimated model, with the scores ``refit``, is poor on the validation experiments.

    Args:
        simulator: makes the one that is needed then.
        progress: is told of it, as it takes as long as a few short refits.
    """
    if not poor(refit) or _beginnings(data) is None or not list(_changes(model)):
        return None
    progress("The validation fit is poor: trying short refits with channels exchanged, or with one of the other sign")
    question = exchanged(data, model, simulator(), mean_fit(held_out_scores(refit)))
    progress(FAR_BETTER_SO if question else NOTHING_CHANGED)
    return question


def poor(scores: Sequence[Score]) -> bool:
    """Whether the scores of a model are so poor on the validation experiments that it is asked."""
    return not mean_fit(held_out_scores(scores)) >= POOR


def exchanged(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> str | None:
    """A question to the user, where exchanging two inputs or two outputs of one unit, or reversing the sign of one channel, makes a short
    refit far better on the validation experiments than these are as they stand; else None.

    None as well where a channel's first sample lies behind what a short refit takes, so that there is nothing to refit.

    Args:
        simulator: of the model, with tangents for its free parameters.
        achieved: the mean fit in % on the validation experiments of the estimate itself; may be minus infinity.
    """
    short, changes = _beginnings(data), list(_changes(model))
    if short is None or not changes:
        return None
    by_start = {k: _fit(short, model, simulator, change, refitted=False) for k, change in enumerate(changes)}
    tried = sorted(by_start, key=lambda k: -by_start[k])[:REFITTED]
    left = 100.0 - max(_fit(short, model, simulator, AS_IT_IS), achieved if np.isfinite(achieved) else -np.inf)
    lefts = {k: 100.0 - _fit(short, model, simulator, changes[k]) for k in sorted(tried)}
    least = min(lefts.values(), default=np.inf)
    if not least < min(FAR_BETTER * left, 100.0 - FOLLOWS):
        return None
    asked = [changes[k].question for k, one in lefts.items() if one <= AS_GOOD * least]
    question = ", or ".join(asked)
    as_it_is = f" ({digits(100.0 - left, 3)} % as it is)" if np.isfinite(left) else ""
    return (
        f"{question[0].upper()}{question[1:]}? So changed, a short refit reaches a mean fit of {100.0 - least:.3g} % on "
        f"{_judging(data)}{as_it_is}. If so, mend the card's columns or scale; if not, disregard this"
    )


def _judging(data: DataSet) -> str:
    return "the validation experiments" if data.validation() else "the experiments"


def _changes(model: GreyBoxModel) -> Iterator[Change]:
    """Exchanges first: of two that fit alike, they are the likelier slip."""
    sides = (model.inputs, model.outputs)
    for signals in sides:
        pairs = [
            (one.name, other.name) for one, other in combinations(signals, 2) if one.unit and one.unit == other.unit
        ]
        for one, other in pairs if len(pairs) <= MOST_ALIKE else ():
            yield Change({one: other, other: one}, f"are the columns of {listed([one, other])} exchanged")
    for signals in sides:
        for signal in signals if len(signals) <= MOST_ALIKE else ():
            yield Change({signal.name: signal.name}, f"is the sign of {signal.name} turned", -1.0)


def _beginnings(data: DataSet) -> DataSet | None:
    """The data set with the beginnings of its experiments, and what the card says of the model; None where one has no sample of a channel
    there.
    """
    runs = []
    for recording in data.recordings:
        count = MOST_SAMPLES // sum(other.role == recording.role for other in data.recordings)
        signals = {name: values[:count] for name, values in recording.signals.items()}
        runs.append(replace(recording, time=recording.time[:count], signals=signals))
    own = {"hold": data.hold, "channels": data.channels, "parameters": data.parameters, "initial": data.initial}
    try:
        return DataSet(runs, **own, held_out_by_default=data.held_out_by_default)
    except UserError:  # a sensor that begins late, or more experiments than samples
        return None


def _fit(data: DataSet, model: GreyBoxModel, simulator: Simulator, change: Change, *, refitted: bool = True) -> float:
    """The mean fit (%) on the validation experiments after a change, of a short refit or of the start values; -inf where none simulates."""
    runs = [change.of(recording) for recording in data.recordings]
    judged = [recording for recording in runs if recording.role == "validation"] or runs
    try:
        values = None
        if refitted:
            estimated = [recording for recording in runs if recording.role == "estimation"]
            problem = make_problem(data, model, estimated)
            found = fit_records(problem, simulator=simulator, settings=ROUGH, with_uncertainty=False, starts=1)
            values = found.problem.values_by_name
        judging = make_problem(data, model, judged, values=values)
        fit = mean_fit(held_out_scores(compare(judging, judged, fine_enough(simulator, judging)).scores))
    except (NumericalError, UserError):  # a change may lead where nothing simulates
        return -np.inf
    return fit if np.isfinite(fit) else -np.inf
