"""Where the only validation experiment shows what the estimation experiments do not: a part of it is taken to choose with as well."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.promotion import Promotion
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study

LEAST_PART = 0.2
"""Share of the recording that either part has at the least."""


@dataclass(frozen=True, kw_only=True)
class Part(Promotion):
    """A data set with the beginning of the experiment ``taken`` among those to choose with; its ``rest`` is left for validation."""

    rest: str

    def sentence(self) -> str:
        """What the reader of a verdict has to know of it."""
        return (
            f"The beginning of {self.taken} was taken to choose with as well, as {self.why}: no more of it than {self.rest} counts as "
            "validation."
        )


def promote_part(study: Study, dataset: DataSet, state: SearchState, others: HeldOut) -> Promotion | None:
    """The data set with the beginning of its only validation experiment among those to choose with; the rest, with as much of the
    model's error, judges.

    None where something was found, where that experiment shows hardly more than the estimation experiments do, where it was divided
    before, or where a part is too short for windows to compare. Seen: a gripper whose finger met its part in the validation recording
    alone: 167 times the noise there, and the verdict could not say what was missing.
    """
    settings, recordings = study.settings, dataset.validation()
    if len(recordings) != 1 or state.effects or _divided(dataset, recordings[0]):
        return None
    (error,), own = others.times_noise(state.plain), times_noise(study.problem, state.plain, settings)
    if not np.isfinite(error) or error < settings.promote_error_beside * max(own, 1.0):
        return None
    last, middle = recordings[0], _middle(recordings[0], others, state)
    if min(middle, len(last) - middle) < settings.fewest_windows * study.budget.shortest_window:
        return None
    rest = f"{last.name} from {last.time[middle]:.4g} s"
    # Start states are by the recording's name, which its beginning keeps.
    both = last.part(0, middle, role="estimation"), last.part(middle, len(last), name=rest)
    recorded = [part for r in dataset.recordings for part in (both if r is last else (r,))]
    why = f"the model as it stands leaves {error:.2g} times the noise there, which the estimation experiments do not show so"
    return Part(replace(dataset, recordings=tuple(recorded)), last.name, why, rest=rest)


def _divided(dataset: DataSet, recording: Recording) -> bool:
    """Whether a recording is what was left of one of which the beginning is chosen with."""
    return any(recording.name.startswith(f"{r.name} from ") for r in dataset.estimation())


def _middle(recording: Recording, others: HeldOut, state: SearchState) -> int:
    """The sample of a window's end before which about half of the model's squared error over windows lies."""
    fit, records = others.fits(state.plain)[0], others.problem.records
    summed = np.cumsum(fit.energies)[:-1]  # not the end of the recording
    begun = fit.windows.start[1:]  # of what is searched, which may have fewer samples
    if not len(begun):
        return 0
    when = records.time(0)[begun[np.argmin(np.abs(summed - 0.5 * fit.energies.sum()))]]
    middle = int(np.searchsorted(recording.time - recording.time[0], when - records.time(0)[0]))
    least = int(LEAST_PART * len(recording))
    return int(np.clip(middle, least, len(recording) - least))
