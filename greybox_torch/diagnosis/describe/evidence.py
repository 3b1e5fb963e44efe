"""What speaks for the verdict, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.describe.beside_noise import beside_noise, why_negligible
from greybox_torch.diagnosis.describe.residual_tests import Detection, Largest
from greybox_torch.diagnosis.describe.unit_of_errors import unit_of_errors
from greybox_torch.diagnosis.describe.unsure import of_little
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import too_few_windows
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.select.remaining import leaves_little
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.diagnosis.verdict import STOPPED
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.name_lists import listed

NEARLY_ALL = 0.999
"""Share that an effect removes from which its interval would be 100.0 to 100.0 %."""

SPEAKS = 0.01
"""Gain by parameters far from the card's values from which it is told."""


def sentences(
    dataset: DataSet,
    study: Study,
    state: SearchState,
    effects: Sequence[Effect],
    gains: Mapping[str, Gain],
    detected: Sequence[Detection],
    interrupted: bool,
) -> tuple[str, ...]:
    """The evidence for a reader: what was looked at, what it showed, and what limits it."""
    plain, final = state.plain.fits, state.current.fits
    lines = [
        _looked(study, state, interrupted),
        "Root mean square error over those windows, model as it stands: "
        + ", ".join(f"{np.sqrt(f.mean_square):.3g}" for f in plain)
        + ("; with the effects: " + ", ".join(f"{np.sqrt(f.mean_square):.3g}" for f in final) if effects else "")
        + f"{unit_of_errors(study)}.",
    ]
    lines += [
        beside_noise(study, state.current),
        *why_negligible(study, state.plain),
        *detection_sentences(detected, bool(effects)),
    ]
    lines += [_step_sentence(done, study, state.plain) for done in state.steps]
    asked = state.memory_step
    lines += [] if asked is None or asked in state.steps else [_memory_sentence(asked)]
    lines += [ceiling_sentence(e) for e in effects if e.ceiling is not None]
    remarks = [(e, remark if remark.endswith("?") else f"{remark}.") for e in effects for remark in e.remarks]
    lines += [f"{spoken_at(e.mechanism, e.port)}: {remark}" for e, remark in remarks]
    spoken_of = {a.prefix: _name(a) for a in state.effects}
    for prefix, gain in gains.items():
        share, interval = _held_out(gain)
        lines.append(
            f"Held out: {spoken_of.get(prefix, prefix)} removes {share} of the squared error that is left without it{interval}."
        )
    kept = {e.prefix for e in effects} | {a.prefix for a in state.effects}  # refinements are in the model, too
    taken = [done.taken.candidate.attachment for done in state.steps if done.taken is not None]
    lines += _removed([a for a in taken if f"{a.port}.{a.mechanism.name}" not in kept], state)
    if dataset.held_out_by_default:
        lines.append(
            "No experiment had the role 'validation': the last quarter of every experiment was held out for judging."
        )
    if interrupted:
        lines.append(STOPPED)
    return tuple(dict.fromkeys(begun(line) for line in lines))  # a search that comes back to a step says the same again


def _removed(lost: Sequence[Attachment], state: SearchState) -> list[str]:
    """What was taken and is not told: names in whose place a free curve stands, and those that nothing confirms."""
    curves = {a.port for a in state.effects if a.mechanism.free}
    replaced = ", ".join(dict.fromkeys(_name(a) for a in lost if a.port in curves and not a.mechanism.free))
    others = ", ".join(dict.fromkeys(_name(a) for a in lost if a.port not in curves or a.mechanism.free))
    told = [f"A free curve stands in the place of {replaced}."] if replaced else []
    return told + ([f"Removed again, as other experiments or effects do not confirm it: {others}."] if others else [])


def _held_out(gain: Gain) -> tuple[str, str]:
    """The share that an effect removes, and its interval in brackets, where that is not all of it."""
    low, high = gain.interval
    if low >= NEARLY_ALL:
        return f"more than {100 * NEARLY_ALL:.1f} %", ""
    return f"{100 * gain.share:.1f} %", f" (95 % interval {100 * low:.1f} to {100 * high:.1f} %)"


def _looked(study: Study, state: SearchState, interrupted: bool) -> str:
    """How many tests were made. A search that was stopped counts those of a step that did not come to its end as well."""
    tests = sum(len(s.screened[0]) for s in state.steps if s.screened)
    tests = max(tests, study.journal.tests) if interrupted else tests
    over = f"over windows of {', '.join(str(f.windows.steps) for f in state.plain.fits)} samples with free start states"
    if interrupted and not tests:
        return f"The search was stopped before any mechanism was tested at a port; the model as it stands was fitted {over}."
    return f"{tests} tests of a mechanism at a port, {over}."


def begun(sentence: str) -> str:
    """A sentence with its first letter large, as names of mechanisms have none."""
    return sentence[:1].upper() + sentence[1:]


def _step_sentence(done: SelectionStep, study: Study, plain: Hypothesis) -> str:
    """What a forward step took beside what was found on top of ``plain``, or why it took nothing."""
    if (taken := done.taken) is not None:
        preferred = (
            ""
            if done.led is None
            else f" By the recordings alone {_name(done.led.candidate.attachment)} would come first; what is believed beforehand decides."
        )
        return (
            f"{_name(taken.candidate.attachment)} lowers the mean squared error by a factor {digits(np.exp(taken.of_errors), 3)}, "
            f"{taken.significance:.1f} standard errors away from chance.{_plausible(taken)}{preferred}"
        )
    settings = study.settings
    little = bool(done.parent.effects) and leaves_little(study, plain, done.parent)
    if not done.ranked:
        if little:
            return f"{_little(settings)}: no further candidate promised in the screen to leave noise alone."
        return "No further candidate promised enough in the screen to be refitted."
    best = done.ranked[0]
    if best.of_errors <= 0:
        return f"The best further candidate, {_name(best.candidate.attachment)}, would not lower it."
    few = too_few_windows(best.fitted, settings)
    away = "too few windows for a standard error" if few else f"{best.significance:.1f} standard errors"
    lowers = (
        f"The best further candidate, {_name(best.candidate.attachment)}, would lower it by "
        f"{digits(100 * (1 - np.exp(-best.of_errors)))} % ({away})"
    )
    if little:
        return f"{lowers}. {begun(of_little(settings))}."
    return f"{lowers}; claimed is what exceeds {100 * least_gain(best.fitted, settings):.0f} % and chance."


def _plausible(taken: RankedCandidate) -> str:
    """What else speaks for a candidate: that the model as it stands is estimated with parameters orders of magnitude from the card's."""
    if taken.plausible <= SPEAKS:
        return ""
    return " It also counts that the model as it stands is estimated with parameters more than ten times from where they began."


def _little(settings: DiagnosisSettings) -> str:
    return f"Less than {100 * settings.least_size:.2g} % of the mismatch was left"


def _memory_sentence(done: SelectionStep) -> str:
    """What residuals with memory would do alone, in the place of what was found."""
    asked = "As neither laws nor curves reach the noise, models with memory (one and two hidden states) were fitted at every port"
    if not done.ranked:
        return f"{asked}; none comes close to the noise."
    best = done.ranked[0]
    return (
        f"{asked}: the best, {_name(best.candidate.attachment)}, alone lowers the mean squared error of the model as it stands by a factor "
        f"{digits(np.exp(best.of_errors), 3)}."
    )


def ceiling_sentence(effect: Effect) -> str:
    """How near a named effect comes to what any law of its kind could explain."""
    share = 100 * (effect.ceiling or 0.0)
    return (
        f"{spoken_at(effect.mechanism, effect.port)} reaches {share:.0f} % of the ceiling: what the best free curve that was fitted in its "
        "place gains (each gain as the logarithm of the factor by which the mean squared error falls)."
    )


def detection_sentences(detected: Sequence[Detection], effects: bool) -> list[str]:
    """What the errors of the free runs show, where that is clearest, and in which recordings the input may answer to the output."""
    lines = []
    if detected:
        lines.append(
            _past_inputs(max(detected, key=lambda d: (d.plain.past.judged, d.plain.past.ratio)), detected, effects)
        )
        first = max(detected, key=lambda d: d.plain.colour.ratio)
        lines.append(
            f"They are {'not ' if first.plain.colour.beyond else ''}white"
            + _changed(first.plain.colour, first.final.colour, "autocorrelation", effects, _place(first, detected))
        )
    answering = [d for d in detected if d.feedback]
    if answering:
        named = list(dict.fromkeys(d.experiment for d in answering))
        clearest, band = max(answering, key=lambda d: d.later.ratio), max(d.band for d in answering)
        lines.append(
            f"What is new in the input is correlated with errors before it, in {listed(named)} ({_size(clearest.later, 'correlation')}): "
            "it may be recorded under feedback, or later than it acts (steps between samples), or samples of a sensor may be wrong (stuck, "
            f"clipped, missing). Coherence above {band:.3g} Hz, where the input is hardly excited, is not counted as evidence."
        )
    return lines


def _past_inputs(first: Detection, detected: Sequence[Detection], effects: bool) -> str:
    within = f" up to {first.band:.3g} Hz" if first.feedback else ""
    if not first.plain.past.judged:
        return (
            f"Whether the free run's errors are correlated with past inputs{within} cannot be judged from these recordings: beside "
            "their length input and errors change so slowly that chance alone gives any correlation "
            f"(the largest is {first.plain.past.told})."
        )
    return (
        f"The free run's errors, model as it stands, are {'' if first.plain.past.beyond else 'not '}correlated with past inputs{within}"
        + _changed(first.plain.past, first.final.past, "correlation", effects, _place(first, detected))
    )


def _place(where: Detection, detected: Sequence[Detection]) -> str:
    return f", in {where.output} of {where.experiment}" if len(detected) > 1 else ""


def _changed(before: Largest, after: Largest, what: str, effects: bool, place: str) -> str:
    bound = f"bound {after.bound:.2g}" if after.judged else "which cannot be judged"
    with_effects = f"; with the effects {after.told} ({bound})" if effects else ""
    return f" ({_size(before, what)}{place}){with_effects}."


def _size(largest: Largest, what: str) -> str:
    return f"largest {what} {largest.told}, 99 % bound {largest.bound:.2g}"


def _name(attachment: Attachment) -> str:
    return spoken_at(attachment.mechanism.name, attachment.port)
