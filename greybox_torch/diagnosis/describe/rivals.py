"""The hypotheses that a next recording would have to decide between: a finding and what comes nearest to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.select.posterior import shares, told_of
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.start_states import starts_of
from greybox_torch.estimate.through_windows import from_windows
from greybox_torch.model import GreyBoxModel

FEW, MOST = 3, 6
"""Rivals that are kept beside a finding: so many, and at most so many where none of these is decided against."""


@dataclass(frozen=True)
class Rival:
    """A hypothesis as it was fitted: ``model`` with its effects, parameter ``values``, start states ``initial`` by recording and state.

    ``finding``: the effect "port.mechanism" that it would take the place of, or is.
    """

    finding: str
    port: str
    mechanism: str
    probability: float
    model: GreyBoxModel
    values: Mapping[str, float]
    initial: Mapping[str, Mapping[str, float]]


def rivals(state: SearchState, settings: DiagnosisSettings, beliefs: Beliefs = NO_BELIEFS) -> tuple[Rival, ...]:
    """Every finding of the state with its likeliest named rivals, the finding first.

    Free curves are left out: they follow any of the laws.
    """
    found: list[Rival] = []
    for effect in state.effects:
        step = state.step_beside_others(effect.prefix)
        if step is None or step.taken is None or step.taken.unknown:
            continue
        ranked = shares(step.taken, step.ranked, settings, beliefs, step.led)
        named = [(r, p) for r, p in ranked if not r.unknown and r.gain > 0][:MOST]
        beside = [(r, p) for k, (r, p) in enumerate(named) if k < FEW or p >= settings.least_class_share]
        told = told_of(step.taken, step.ranked, settings, beliefs, step.led)
        own = settings.highest_probability - sum(told.values())
        found.append(_rival(effect.prefix, step.taken, own))
        found += [_rival(effect.prefix, r, told[r.candidate.attachment.named]) for r, _ in beside]
    return tuple(found)


def _rival(finding: str, candidate: RankedCandidate, probability: float) -> Rival:
    fitted, attachment = candidate.fitted, candidate.candidate.attachment
    starts = starts_of(from_windows(fitted.fits[-1]))
    return Rival(
        finding, attachment.port, attachment.mechanism.name, probability, fitted.model, fitted.values(), starts
    )
