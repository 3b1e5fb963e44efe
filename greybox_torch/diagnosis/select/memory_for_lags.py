"""An unknown that remembers in the place of lags and dead times, beside the other laws."""

from __future__ import annotations

from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.memory import linear_residual
from greybox_torch.diagnosis.select.remaining import completes
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.actuator import InputDelay, InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag


def with_memory_for_lags(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with one unknown that remembers in the place of its lags and dead times, where that completes the model beside the rest.

    What an actuator does no faster than it can looks like a lag, which is taken first and leaves much; further lags then take up pieces of
    that. Alone, without the other laws, what remembers does not complete the model either. Seen: a fan's drag and its drive's ramp, told as
    the drag, a lag of each sensor (0.85) and a curve.
    """
    rest = tuple(e for e in state.effects if not _late(e))
    if (
        not rest
        or len(rest) == len(state.effects)
        or state.has_curve
        or not far_above_noise(state.current, study.settings)
    ):
        return state
    study.working_on("asking for what remembers in the place of lags")
    beside = fit(study, rest, [state.current.values()], state.current.fits[0])
    if beside is None:
        return state
    found = linear_residual(study, state.at(beside), state)
    if found.took_one and completes(found.current, study.settings):
        yield found
        return found
    return state


def _late(effect: Attachment) -> bool:
    """Whether an effect is a signal's lag or dead time."""
    return isinstance(effect.mechanism, InputLag | InputDelay | SensorLag | OutputDelay)
