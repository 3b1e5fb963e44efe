"""Short refits with channels changed: what a slip on the card would explain, on the beginnings of the experiments."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnosis.digits import digits
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.comparison import compare, held_out_scores, mean_fit
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.levenberg_marquardt import ROUGH
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import Simulator

MOST_SAMPLES = 4000
"""Samples of the experiments of a role that it is asked with: the beginnings of all. A hint is worth no more time."""

REFITTED = 3
"""Changes that are refitted, those that simulate best with the start values."""

FAR_BETTER = 0.5
"""Part of what is missing to a fit of 100 % that may be left for a change to be told."""

FOLLOWS = 30.0
"""Mean fit in % that a change has to reach: of free runs that go elsewhere, the one that goes least far says nothing."""

HARDLY = 1e-3
"""Times its weight that an output counts in a refit without it; none at all would leave parameters open that only it shows."""

AS_GOOD = 1.2
"""Times as much that others may leave and be told with it."""


@dataclass(frozen=True)
class Change:
    """``read`` says, by channel, whose values it is to have instead, and ``question`` how a reader is asked.

    The values are multiplied by ``factor``, −1 where a sign is turned, and by what ``factors`` has for the channel; ``more`` is added then.
    ``only``: names of the recordings that are changed, all where it is empty.
    """

    read: Mapping[str, str]
    question: str
    factor: float = 1.0
    only: tuple[str, ...] = ()
    factors: Mapping[str, float] = field(default_factory=dict)
    more: float = 0.0

    def of(self, recording: Recording) -> Recording:
        """A recording with the change."""
        if self.only and recording.name not in self.only:
            return recording
        times = {n: self.factor * self.factors.get(n, 1.0) for n in self.read}
        changed = {n: times[n] * recording.signals[o] + self.more for n, o in self.read.items()}
        between = {name: recording.between[other] for name, other in self.read.items() if other in recording.between}
        kept = {name: marked for name, marked in recording.between.items() if name not in self.read}
        return replace(recording, signals={**recording.signals, **changed}, between={**kept, **between})


AS_IT_IS = Change({}, "")


@dataclass(frozen=True)
class Asked:
    """A ``question`` to the user, without its full stop, and the mean fit in % that a short refit ``reaches`` on the validation experiments
    with the channels as it has them. ``lead``: what the question begins with, up to what was changed, which a headline goes on from.
    ``channels``: those that it is about.
    """

    question: str
    reaches: float
    lead: str
    channels: frozenset[str] = frozenset()


def beginnings(data: DataSet) -> DataSet | None:
    """The data set with the beginnings of its experiments, and what the card says of the model; None where one has no sample of a channel
    there.
    """
    runs = []
    for recording in data.recordings:
        count = MOST_SAMPLES // sum(other.role == recording.role for other in data.recordings)
        signals = {name: values[:count] for name, values in recording.signals.items()}
        between = {name: marked[:count] for name, marked in recording.between.items()}
        runs.append(replace(recording, time=recording.time[:count], signals=signals, between=between))
    own = {"hold": data.hold, "channels": data.channels, "parameters": data.parameters, "initial": data.initial}
    try:
        return DataSet(runs, **own, held_out_by_default=data.held_out_by_default)
    except UserError:  # a sensor that begins late, or more experiments than samples
        return None


def fit_after(
    data: DataSet,
    model: GreyBoxModel,
    simulator: Simulator,
    change: Change,
    *,
    refitted: bool = True,
    values: Mapping[str, float] | None = None,
) -> float:
    """The mean fit (%) on the validation experiments after a change, of a short refit or of the start values; -inf where none simulates.

    That of the start values after a change of one experiment is told of that experiment.

    Args:
        values: of parameters, in the place of the start values.
    """
    runs = [change.of(recording) for recording in data.recordings]
    judged = [recording for recording in runs if recording.role == "validation"] or runs
    if change.only and not refitted:
        judged = [recording for recording in runs if recording.name in change.only]
    try:
        if refitted:
            estimated = [recording for recording in runs if recording.role == "estimation"]
            problem = make_problem(data, model, estimated, values=values)
            found = fit_records(problem, simulator=simulator, settings=ROUGH, with_uncertainty=False, starts=1)
            values = found.problem.values_by_name
        judging = make_problem(data, model, judged, values=values)
        fit = mean_fit(held_out_scores(compare(judging, judged, fine_enough(simulator, judging)).scores))
    except (NumericalError, UserError):  # a change may lead where nothing simulates
        return -np.inf
    return fit if np.isfinite(fit) else -np.inf


def values_without(
    data: DataSet, model: GreyBoxModel, simulator: Simulator, outputs: Collection[str]
) -> Mapping[str, float] | None:
    """The parameters of a short refit that hardly counts the errors of some ``outputs``; None where it fails."""
    problem = make_problem(data, model, data.estimation())
    left_out = np.array([output.name in outputs for output in model.outputs], dtype=bool)
    problem = replace(problem, weights=np.where(left_out, HARDLY * problem.weights, problem.weights))
    try:
        found = fit_records(problem, simulator=simulator, settings=ROUGH, with_uncertainty=False, starts=1)
    except NumericalError:
        return None
    return found.problem.values_by_name


def as_it_is(short: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> float:
    """The mean fit in % on the validation experiments of the estimate itself, ``achieved``, or of a short refit, whichever is larger."""
    return max(fit_after(short, model, simulator, AS_IT_IS), achieved if np.isfinite(achieved) else -np.inf)


def far_better(
    short: DataSet,
    model: GreyBoxModel,
    simulator: Simulator,
    tried: Sequence[Change],
    achieved: float,
    *,
    refitted: bool = False,
) -> tuple[float, list[float]] | None:
    """What is missing to a fit of 100 % as it is, of the estimate or a short refit, and after each change that is refitted; None where none
    of these is far better.

    Args:
        achieved: the mean fit in % on the validation experiments of the estimate itself; may be minus infinity.
        refitted: whether that is one of :func:`as_it_is` already.
    """
    if not tried:
        return None
    left = 100.0 - (achieved if refitted else as_it_is(short, model, simulator, achieved))
    lefts = [100.0 - fit_after(short, model, simulator, change) for change in tried]
    return (left, lefts) if is_far_better(left, min(lefts)) else None


def is_far_better(left: float, rest: float) -> bool:
    """Whether a change that leaves ``rest`` to a fit of 100 % is far better than what is ``left`` as it is."""
    return rest < min(FAR_BETTER * left, 100.0 - FOLLOWS)


def asked_of(
    tried: Sequence[Change],
    found: tuple[float, list[float]] | None,
    data: DataSet,
    mend: str,
    so: str = "So changed",
) -> Asked | None:
    """The question whether the best of the changes that were refitted is so, or one that is as good; None where :func:`far_better` has
    found none. ``mend``: what to do then; ``so``: what was refitted.
    """
    if found is None:
        return None
    left, lefts = found
    asked = [change for change, one in zip(tried, lefts, strict=True) if one <= AS_GOOD * min(lefts)]
    question = ", or ".join(change.question for change in asked)
    as_it_is = f" ({digits(100.0 - left, 3)} % as it is)" if np.isfinite(left) else ""
    reaches = 100.0 - min(lefts)
    lead = f"{question[0].upper()}{question[1:]}? {so}"
    told = (
        f"{lead}, a short refit reaches a mean fit of {reaches:.3g} % on "
        f"{judging(data)}{as_it_is}. If so, mend {mend}; if not, disregard this"
    )
    return Asked(told, reaches, lead, frozenset(name for change in asked for name in change.read))


def judging(data: DataSet) -> str:
    """The experiments that a change is judged on, in words."""
    return "the validation experiments" if data.validation() else "the experiments"
