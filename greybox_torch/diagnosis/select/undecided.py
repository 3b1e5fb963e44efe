"""Which rivals of an effect the recordings leave a part of its probability."""

from __future__ import annotations

from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.select.posterior import shares
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def undecided(study: Study, state: SearchState, effect: Attachment) -> list[RankedCandidate]:
    """The laws of which each may well be meant instead of ``effect``, the likeliest first; none for a free curve."""
    return _told(study, state, effect, study.settings.least_class_share)


def listed(study: Study, state: SearchState, effect: Attachment) -> list[RankedCandidate]:
    """The same, and those that are hardly believed: a law that does the same and has more parameters is among them."""
    return _told(study, state, effect, study.settings.least_alternative)


def _told(study: Study, state: SearchState, effect: Attachment, least: float) -> list[RankedCandidate]:
    """The laws that are told with at least this probability."""
    done, settings = state.step_beside_others(effect.prefix), study.settings
    if done is None or done.taken is None or effect.mechanism.free:
        return []
    told = shares(done.taken, done.ranked, settings, study.beliefs, done.led, calibrated=True)
    return [r for r, share in told if share >= least and not r.unknown and sound(study, r)]
