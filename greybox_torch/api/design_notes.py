"""What a reader of a designed recording has to know beside what it is expected to say."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from greybox_torch.api.design_files import CARD, INPUT, RECORDED
from greybox_torch.api.design_groups import AGAINST_GROUPS
from greybox_torch.data import DataSet
from greybox_torch.diagnosis.digits import digits
from greybox_torch.experiment_design.limits import EVERY_INPUT, WIDENED
from greybox_torch.in_unit import in_unit
from greybox_torch.name_lists import listed

if TYPE_CHECKING:
    from greybox_torch.api.design_result import DesignResult

SMALL = 0.25
"""Share of its range of which an input that takes less is small."""
FASTER = 2.0
"""Times the fastest change that was recorded from which a change is faster."""
CLOSE = 0.02
"""Share of its range within which an output is close to its limit."""


def design_notes(found: DesignResult) -> list[str]:
    """Sentences for below the table, one a line."""
    lines = [*found.left_out, *_told_apart(found), *_deviations(found), *recorded_as_limits(found), *_in_the_way(found)]
    lines += _unlimited_rates(found)
    if found.limits.seconds > 1.001 * found.seconds:
        lines.append(
            f"Designed for the first {digits(found.seconds, 4)} of {digits(found.limits.seconds, 4)} s; "
            "repeated, it says more in proportion to the time."
        )
    if len(found.limits.designed) > 1:
        lines.append(EVERY_INPUT)
    if found.parameter is None and not found.expected.worth_recording:
        return [
            *lines,
            f"{INPUT} holds the best that was found; it is not worth recording. Wider limits or more seconds may help.",
        ]
    for name, output in found.follows.items():
        lines.append(
            f"Simulated under feedback: the controller drives {name}, so that {output} follows its set point, which {INPUT} holds. "
            f"Record the {name} that reaches the machine; a diagnosis takes that."
        )
    lines += _beginning(found)
    lines.append(f"Record it, save it as {RECORDED} beside {CARD}, and diagnose the old recordings together with it.")
    return lines


def recorded_as_limits(found: DesignResult) -> Iterator[str]:
    """Which limits are not given, and what was taken in their place."""
    limits, names = found.limits, found.limits.recorded
    ranges = {**limits.outputs, **limits.inputs}
    told = {n: in_unit(f"{ranges[n].lower:.4g} to {ranges[n].upper:.4g}", found.data.channels[n].unit) for n in names}
    inputs = [f"{n} ({told[n]})" for n in names if n in limits.inputs]
    outputs = [f"{n} ({told[n]})" for n in names if n not in limits.inputs]
    kinds = [f"for {listed(inputs)}"] if inputs else []
    kinds += [f"with {100 * WIDENED:.0f} % more either way for {listed(outputs)}"] if outputs else []
    if kinds:
        rest = len(limits.held) + len(limits.not_in_steps)
        few = "No limits are" if len(names) + rest == len(ranges) else "Not all limits are"
        yield f"{few} given under [limits] on the card (in Python limits=): the recorded range was taken, {', '.join(kinds)}."
    if limits.held:
        kept = [in_unit(f"{n} ({ranges[n].lower:.4g}", found.data.channels[n].unit) + ")" for n in limits.held]
        verb = "is" if len(kept) == 1 else "are"
        yield (
            f"Constant in every recording, and kept as {found.begins_like} has it, {verb} {listed(kept)}: "
            "with lower and upper under [limits] it would be designed."
        )
    if limits.kept:
        yield from _kept(found)


def _unlimited_rates(found: DesignResult) -> Iterator[str]:
    """Which inputs and set points without a rate change faster than they ever did in the recordings."""
    for name in found.limits.designed:
        signal = found.follows.get(name, name)
        values = found.set_points[signal] if name in found.follows else found.inputs[name]
        step = float(found.time[1] - found.time[0])
        change = float(np.abs(np.diff(values)).max())
        if np.isfinite(found.limits.commanded[name].rate) or change <= FASTER * _fastest(found.data, signal, step):
            continue
        unit = found.data.channels[signal].unit
        yield (
            f"Nothing limits how fast {f'the set point of {signal}' if signal != name else name} changes: here by "
            f"{in_unit(digits(change, 3), unit)} from one sample to the next, {digits(step, 3)} s later, faster than in any recording. "
            f"Where that is too fast for the machine, give its rate, per second, under [limits] on the card (in Python limits=): "
            f"{signal} = {{ rate = … }}."
        )


def _fastest(data: DataSet, name: str, step: float) -> float:
    """The largest change of a channel within ``step`` seconds in any recording, in its unit: of noise and counts it grows less than by the
    time. Where samples are farther apart, a share of that from one to the next.
    """
    changes = []
    for recording in data.recordings:
        apart = max(min(round(step / recording.sample_time), len(recording.time) - 1), 1)
        values, time = recording.signals[name], recording.time
        change = np.abs(values[apart:] - values[:-apart]) * np.minimum(step / (time[apart:] - time[:-apart]), 1.0)
        changes.append(float(change[np.isfinite(change)].max(initial=0.0)))
    return max(changes)


def _in_the_way(found: DesignResult) -> Iterator[str]:
    """Which limits of outputs keep inputs small that may move further."""
    limits, channels = found.limits, found.data.channels
    small = []
    for name in (n for n in limits.designed if n not in found.follows):
        low, high, own = found.inputs[name].min(), found.inputs[name].max(), limits.inputs[name]
        if high - low < SMALL * (own.upper - own.lower):
            small.append(
                f"{name} ({in_unit(f'{low:.4g} to {high:.4g}', channels[name].unit)} of {own.lower:.4g} to {own.upper:.4g})"
            )
    reached = []
    for k, (name, own) in enumerate(limits.outputs.items()):
        low, high = (end([end(y[:, k]) for y in found.outputs]) for end in (min, max))
        close = CLOSE * (own.upper - own.lower)
        reached += [
            (name, e) for e, gap in ((own.lower, low - own.lower), (own.upper, own.upper - high)) if gap < close
        ]
    if small and reached:
        ends = listed([f"{name} is not to pass {in_unit(f'{end:.4g}', channels[name].unit)}" for name, end in reached])
        yield f"Small is {listed(small)}, as {ends}: wider limits would give more room."


def _kept(found: DesignResult) -> Iterator[str]:
    """Which inputs are as they were recorded, why, and what that means."""
    limits = found.limits
    asked = [n for n in limits.kept if n not in limits.not_in_steps]
    if asked:
        yield f"Kept as in {found.begins_like}, as asked for: {listed(asked)}."
    if limits.not_in_steps:
        yield (
            f"Kept as in {found.begins_like}: {listed(limits.not_in_steps)}, never set in steps, given a range or driven by a "
            "controller, unlike other inputs, and so taken to be measured, as weather is. With lower and upper under [limits] "
            "an input is designed."
        )
    length = min(len(trace) for trace in limits.kept.values())
    again = " (beyond the end of that recording, backwards)" if length < len(found.time) else ""
    yield f"The predicted differences hold for these inputs{again}; record what really occurs."


def _beginning(found: DesignResult) -> Iterator[str]:
    """How it begins; where that is in motion, how to ask for a start at rest."""
    units = {s.name: s.unit for s in found.hypotheses[0].states}
    moved = {
        name: in_unit(f"{name} = {value:.3g}", units.get(name, ""))
        for name, value in found.start.items()
        if name not in found.resting
    }
    rest = [f"{listed(found.resting)} at rest"] if found.resting else []
    shown = [told for name, told in moved.items() if name in found.data.channels or name in found.limits.start]
    hidden = [told for told in moved.values() if told not in shown]
    no_sensor = [f"by the estimate {listed(hidden)}, which no sensor shows"] if hidden else []
    began = ", ".join([*rest, *shown, *no_sensor])
    if found.limits.start:
        yield f"Begin with {began}: {', '.join(found.limits.start)} as asked for, all else as {found.begins_like} began."
    else:
        yield f"Begin as {found.begins_like} began: {began}."
    yield from _within_rates(found)
    if found.moving:
        zero = ", ".join(f"{name} = 0" for name in found.moving)
        yield (
            f"That is in motion ({', '.join(found.moving)}). To begin at rest, give the start under [limits] on the card, "
            f"start = {{ {zero} }} (in Python limits=); a position at which the machine rests can be given there as well."
        )


def _within_rates(found: DesignResult) -> Iterator[str]:
    """Where inputs begin whose rate is limited."""
    units = {name: channel.unit for name, channel in found.data.channels.items()}
    at = [
        in_unit(f"{name} = {value:.4g}", units.get(name, ""))
        for name, value in found.limits.begin.items()
        if name not in found.follows
    ]
    if at:
        yield (
            f"{INPUT} begins with {listed(at)}, as that recording did or as near as the limits allow, and changes from there at the "
            "limited rate."
        )


def _deviations(found: DesignResult) -> Iterator[str]:
    """Why the deviation before the recording is not the one that a fit tells."""
    if found.parameter is None:
        return
    if found.memory > 1.5:
        yield (
            f"Both deviations are cautious: errors so far are correlated over up to {digits(found.memory)} samples, and so many count as "
            "one. The report's ± and greybox fit take the correlation as it is and tell less; compare before and after with each other."
        )
    else:
        yield (
            "Both deviations take errors for independent from sample to sample, and weigh each output by the size of its errors. The "
            "report's ± and greybox fit weigh errors in other ways and may tell more or less; compare before and after with each other."
        )


def _told_apart(found: DesignResult) -> Iterator[str]:
    """Which hypotheses stay alike where others are told apart, and what a random input would do."""
    if found.parameter is not None or not found.expected.decides:
        return
    what, as_set_points = found.what, found.as_set_points
    if found.expected.by_groups:
        yield AGAINST_GROUPS
    else:
        for a, b in found.alike:
            yield f"No {what} within the limits was found that tells {a} from {b} in {digits(found.seconds, 4)} s, whichever is right."
        if found.alike:
            yield "Those count as one in the probability that is expected."
    if found.expected.random is not None:
        as_well = ", as well as the designed one" if found.expected.random_does_as_well else ""
        yield f"A random multisine of the same power{as_set_points}: {found.expected.random:.2f}{as_well}."
