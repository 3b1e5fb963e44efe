"""Which hypotheses these recordings do not tell from a finding, and what they say together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.describe.statement import Member, statement
from greybox_torch.diagnosis.hypothesis.divergence import divergence
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.select.posterior import shares, told_of
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.one_effect import one_effect
from greybox_torch.model import GreyBoxModel


def one_of(
    model: GreyBoxModel,
    step: SelectionStep,
    probability: float,
    settings: DiagnosisSettings,
    beliefs: Beliefs = NO_BELIEFS,
    values: Mapping[str, float] | None = None,
    borne_out: float = 1.0,
) -> OneOf | None:
    """The finding of a step with its rivals whose fitted outputs differ from its own by less than could be seen, or between which these
    recordings are undecided; None where it stands alone.

    A law that contains the whole force of the one found says the same where what it has more is not seen: it is a rival only where the
    recordings are undecided between the two. A free curve is none. One that is next to nothing counts in the
    whole but is not named.

    Args:
        model: the plain one, whose inputs and outputs the ports belong to.
        probability: of the finding.
        values: parameters of the recommended model, with all effects and fitted to whole records; by default as the step left them.
        borne_out: how likely it is that anything is there, by which the shares of the rivals are less.
    """
    taken = step.taken
    if taken is None or taken.unknown:
        return None
    found = [(taken, probability)]
    told = told_of(taken, step.ranked, settings, beliefs, step.led)
    for rival, share in shares(taken, step.ranked, settings, beliefs, step.led):
        attachment = rival.candidate.attachment
        if rival.unknown:
            continue
        contains = taken.candidate.attachment.mechanism.name in attachment.mechanism.includes
        says_the_same = contains and attachment.port == taken.candidate.attachment.port
        undecided = share >= settings.least_class_share
        if undecided or (not says_the_same and divergence(taken.fitted, rival.fitted) < settings.visible_divergence):
            found.append((rival, borne_out * told[attachment.named]))
    named = [
        (candidate, share) for candidate, share in found if candidate is taken or share >= settings.least_alternative
    ]
    if len(named) == 1:
        return None
    members = _as_recommended([_member(model, candidate, share) for candidate, share in named], taken, values or {})
    alternatives = tuple(_told(taken, r, member) for (r, _), member in zip(named, members, strict=True))
    return OneOf(
        statement(members),
        round(min(sum(round(share, 4) for _, share in found), settings.highest_probability), 4),
        alternatives,
    )


def _member(model: GreyBoxModel, candidate: RankedCandidate, probability: float) -> Member:
    attachment = candidate.candidate.attachment
    site = next(p for p in model.all_ports if p.name == attachment.port)
    _, size, unit = _first_parameter(candidate)
    return Member(
        attachment.port,
        attachment.mechanism.name,
        attachment.mechanism.nature,
        round(probability, 4),
        signal=getattr(site, "input", "") or getattr(site, "output", ""),
        is_sensor=site.kind == "sensor",
        size=size,
        unit=unit,
    )


def _as_recommended(members: list[Member], taken: RankedCandidate, values: Mapping[str, float]) -> tuple[Member, ...]:
    """The members, that which was ``taken`` first, with its size in the recommended model, and those of its unit in proportion.

    A step knows nothing of the effects that were found after it. Seen: dry friction of "about 0.0027 N m" above a table that had 0.0048,
    as a mode found beside it had taken much of what friction made up for.
    """
    first = members[0]
    final = values.get(f"{taken.candidate.attachment.prefix}.{_first_parameter(taken)[0]}")
    if final is None or not first.size:
        return tuple(members)
    by = abs(final / first.size)
    alike = (m.size is not None and m.unit == first.unit for m in members)
    return tuple(
        replace(m, size=by * (m.size or 0.0) or None) if same else m for m, same in zip(members, alike, strict=True)
    )


def _told(taken: RankedCandidate, candidate: RankedCandidate, member: Member) -> Alternative:
    """The member as a verdict has it, with its value, and whether it is one effect with the finding."""
    name, _, unit = _first_parameter(candidate)
    own, its = taken.fitted, candidate.fitted
    same = candidate is not taken and one_effect(own.model, its.model, own.values(), its.values())
    return Alternative(member.port, member.mechanism, member.probability, name, member.size, unit, same)


def _first_parameter(candidate: RankedCandidate) -> tuple[str, float | None, str]:
    """The name, value and unit of a law's first parameter, which is what it is mostly about: a time, a force, a gain."""
    prefix = f"{candidate.candidate.attachment.prefix}."
    own = [p for p in candidate.fitted.model.declared_parameters if p.name.startswith(prefix)]
    if not own:
        return "", None, ""
    return own[0].name.removeprefix(prefix), candidate.fitted.values()[own[0].name], own[0].unit
