"""The findings in the form of the verdict: parameters, place, share explained, alternatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from greybox_torch.deadline import Deadline, until
from greybox_torch.diagnosis.confirm.beyond_chance import part_borne_out
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.describe.amplitudes import wave_amplitudes
from greybox_torch.diagnosis.describe.conversion_as_gain import conversion_as_gain
from greybox_torch.diagnosis.describe.equation import equation
from greybox_torch.diagnosis.describe.indistinguishable import one_of
from greybox_torch.diagnosis.describe.law_over_data import over_data
from greybox_torch.diagnosis.describe.line_tried import line_tried
from greybox_torch.diagnosis.describe.memory import remembered, settled_curve
from greybox_torch.diagnosis.describe.one_direction import with_likes
from greybox_torch.diagnosis.describe.profiles import explained_energy, profile, with_samples
from greybox_torch.diagnosis.describe.shared_with_parameters import shared_with_parameters
from greybox_torch.diagnosis.describe.sign_of_term import sign_of_term
from greybox_torch.diagnosis.describe.signal_names import as_named, signal_name, unit_told
from greybox_torch.diagnosis.describe.straight_line import straight_line
from greybox_torch.diagnosis.describe.where import where
from greybox_torch.diagnosis.describe.why_limited import why_limited
from greybox_torch.diagnosis.describe.without_unit import without_unit
from greybox_torch.diagnosis.effect import Effect, Profile
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.hypothesis.signals_along import local_signals
from greybox_torch.diagnosis.one_of import Alternative
from greybox_torch.diagnosis.select.all_that_is_left import LeftInFreeRuns, lowest, lowest_limit, sizes_at
from greybox_torch.diagnosis.select.posterior import by_comparison, shared
from greybox_torch.diagnosis.select.remaining import remaining_share
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.select.told_from_time import limited_by_time
from greybox_torch.diagnosis.stopping import or_else
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.notes import at_bounds
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model.ports import Port


@dataclass(frozen=True)
class _Account:
    """What an effect accounts for: shares of the validation error and of the mismatch, the gain on held-out experiments, if any, and the
    sizes of all effects at its port."""

    explained: float
    size: float
    gain: Gain | None
    at_its_port: tuple[float, ...]


def describe(
    study: Study,
    state: SearchState,
    final: Final,
    left: LeftInFreeRuns,
    gains: Mapping[str, Gain],
    sizes: Mapping[str, float],
    removed: float,
    deadline: Deadline = Deadline(),
) -> tuple[Effect, ...]:
    """The effects of the search's final hypothesis.

    Args:
        final: that hypothesis fitted to whole records.
        left: what they leave in free runs of the validation experiments.
        gains: by effect, on held-out experiments, where there are any.
        sizes: by effect, the share of the whole mismatch that it accounts for.
        removed: the share of the validation error beyond the noise that they remove together.
        deadline: when what a description can do without, straight lines in the place of curves, has to end.
    """
    told = tuple(
        _effect(
            study,
            state,
            final,
            left,
            e,
            _Account(
                removed * part,
                sizes.get(e.prefix, np.nan),
                gains.get(e.prefix),
                sizes_at(e.port, state, sizes, study.settings),
            ),
            deadline,
        )
        for e, part in zip(state.effects, _parts(state), strict=True)
    )
    return with_likes(state.current, told, final.problem)


def _parts(state: SearchState) -> list[float]:
    """How the explained error divides among several effects, by the gain of the step in which each was taken."""
    gains = []
    for effect in state.effects:
        taken = state.step_of(effect.prefix)
        gains.append(1.0 if taken is None or taken.taken is None else max(taken.taken.gain, 1e-6))
    return [g / sum(gains) for g in gains] if len(gains) > 1 else [1.0]


def _effect(
    study: Study,
    state: SearchState,
    final: Final,
    left: LeftInFreeRuns,
    attachment: Attachment,
    account: _Account,
    deadline: Deadline,
) -> Effect:
    model, gain = state.current.model, account.gain
    assert isinstance(model, AugmentedModel)
    taken = state.step_beside_others(attachment.prefix)
    borne_out = part_borne_out(gain, study.settings)
    uncapped, alternatives = _probability(study, state, attachment, taken, borne_out)
    remaining, free = remaining_share(state.plain, state.current, study.settings), attachment.mechanism.free
    ceiling = None if taken is None else ceiling_share(taken, state.memory_step)
    site = next(p for p in model.base.all_ports if p.name == attachment.port)
    local = local_signals(model, attachment, state.current.fits[0], state.current.simulator)
    read = {*attachment.mechanism.signals(), *attachment.mechanism.needs}
    limit = lowest(
        limited_by_time({n: v for n, v in local.items() if n in read}, study.problem.records, study.settings),
        lowest_limit(
            remaining,
            state.current,
            study.settings,
            left,
            free=free,
            ceiling=ceiling,
            size=account.size,
            at_its_port=account.at_its_port,
        ),
    )
    probability = uncapped if limit is None else min(uncapped, limit.highest)
    profiles = _profiles(study, state, model, attachment, site, local)
    timelines = () if gain is None else gain.timelines
    mechanism, around = attachment.mechanism, study.surroundings[attachment.port]
    curve = settled_curve(attachment, around, final) or over_data(study, state.current, attachment, final.problem)
    told = (study.settings, study.beliefs, final.values(), borne_out)
    members = None if taken is None else one_of(model.base, taken, probability, *told)
    parameters, prefix = _parameters(model, attachment, final), f"{attachment.prefix}."
    if members is not None and (first := parameters.get(members.members[0].parameter)):
        members = members.finding_with(first["value"])
    named = partial(signal_name, model.base, site)
    own = "" if curve is None else named(curve.signal)
    curve = as_named(with_samples(curve, local, mechanism.repeats), model.base, site, mechanism.signals()[:1])
    memory = remembered(attachment, around, final, named(mechanism.signals()[0])) if mechanism.free else None
    line = straight_line(curve if isinstance(mechanism, Unknown) and not mechanism.kinematic else None, site, own)
    trial = partial(line_tried, study, state.current, final, attachment, site)
    with until(deadline):
        tried, _ = (None, True) if line else or_else(trial, lambda: None)
    return Effect(
        port=attachment.port,
        mechanism=Unknown.name if mechanism.free else mechanism.name,
        probability=probability,
        signals=tuple(named(s) for s in mechanism.signals()),
        where=where(profiles, timelines, mechanism.acts_beyond({n: float(v["value"]) for n, v in parameters.items()})),
        parameters=parameters,
        explained=round(account.explained, 4),
        alternatives=alternatives,
        curve=curve,
        memory=memory,
        profiles=profiles,
        explanation=mechanism.explanation,
        source=mechanism.source,
        separating_experiment=mechanism.experiment,
        ceiling=ceiling,
        timelines=timelines,
        one_of=members,
        law=mechanism.name,
        equation=line
        or ("" if tried is None else tried.equation)
        or equation(attachment, site, around, named, list(parameters)),
        at_bounds=tuple(n.removeprefix(prefix) for n in at_bounds(final.problem) if n.startswith(prefix)),
        form=mechanism.nature if mechanism.free else "",
        of_units=conversion_as_gain(attachment, around, parameters)
        or without_unit(attachment, site, around, parameters),
        amplitudes=wave_amplitudes(attachment, final),
        of_line="" if tried is None else tried.told,
        shared=shared_with_parameters(state.current, attachment, final.problem, curve),
        of_sign=sign_of_term(state.current, final, attachment),
        limited=why_limited(uncapped, limit, gain, study.settings),
        size=account.size,
    )


def _probability(
    study: Study, state: SearchState, attachment: Attachment, taken: SelectionStep | None, borne_out: float
) -> tuple[float, tuple[Alternative, ...]]:
    """The probability of an effect and of its alternatives, as far as held-out experiments have ``borne_out`` that anything is there."""
    if taken is None or taken.taken is None:
        without = state.without.get(attachment.prefix, state.plain)
        probability, alternatives = by_comparison(without, state.current, study.settings), ()
    else:
        probability, alternatives = shared(taken.taken, taken.ranked, study.settings, study.beliefs, taken.led)
    scaled = (replace(a, probability=round(borne_out * a.probability, 4)) for a in alternatives)
    likely = (a for a in scaled if borne_out == 1.0 or a.probability >= study.settings.least_alternative)
    return round(borne_out * probability, 4), tuple(likely)


def ceiling_share(done: SelectionStep, memory: SelectionStep | None = None) -> float | None:
    """The share of the best free curve's gain, in the logarithm of the mean squared error, that the named effect of a step reaches.

    At most one, where the law does better than any curve; None where there is no curve beside it in the step, and where the error is not
    all that speaks for both.

    Args:
        memory: the step in which residuals with memory were offered, where there was one: fitted in the same place they count as curves.
    """
    gains = [r.gain for r in done.ranked if r.unknown]
    if memory is not None and memory.parent.effects == done.parent.effects:
        gains += [r.gain for r in memory.ranked]
    if done.taken is None or done.taken.unknown or not gains or done.taken.gain <= 0:
        return None
    if done.taken.plausible > 0.0:
        return None
    return round(done.taken.gain / max(done.taken.gain, *gains), 4)


def _parameters(model: AugmentedModel, attachment: Attachment, final: Final) -> dict[str, dict[str, Any]]:
    values, deviations = final.values(), final.told.deviations()
    start = f"{attachment.prefix}."
    result: dict[str, dict[str, Any]] = {}
    for one in model.declared_parameters:
        if one.name.startswith(start):
            # infinite where the recordings do not determine it; None where it was not estimated, or whole records were not fitted
            own = {"value": values[one.name], "std": deviations.get(one.name), "unit": one.unit}
            result[one.name.removeprefix(start)] = own | ({"description": one.description} if one.description else {})
    return result


def _profiles(
    study: Study, state: SearchState, model: AugmentedModel, attachment: Attachment, site: Port, local: dict[str, Any]
) -> tuple[Profile, ...]:
    energy = explained_energy(state.without.get(attachment.prefix, state.plain), state.current)
    around = study.surroundings[attachment.port]
    wanted = attachment.mechanism.signals() or tuple(site.signals)[:1]
    return tuple(
        profile(signal_name(model.base, site, name), unit_told(model.base, site, around, name), local[name], energy)
        for name in wanted
        if name in local and np.ptp(local[name]) > 0
    )
