"""The frequency response, measured against before and after, for effects that are linear: lags, delays, gains, further modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.describe.residual_tests import input_answers
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.traces import InputTrace, Trace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.excitation import excited_band
from greybox_torch.estimate.frequency_response import Response, frequency_response
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.report.chart.panel import Chart
from greybox_torch.report.sections.bode import Curves, bode
from greybox_torch.report.sections.traces import validation_traces

MOST_PAIRS = 2
"""Pairs of an input and an output that are drawn for one effect."""

APART = 4.0
"""Median distances of clear frequencies from which a lone one at an end is left out: it may be clear by chance, and no band joins it."""
FEWEST = 8
"""Frequencies at least at which a response has to stand out of its uncertainty to be drawn."""

CERTAIN = 0.35
"""Largest radius of the 95 % region, as a share of the amplitude, up to which a value is drawn."""

REGION = float(np.sqrt(-np.log(0.05)))
"""Radius of the region in the complex plane that holds 95 % of a circular normal distribution, in its standard deviations."""


@dataclass(frozen=True)
class Recorded:
    """Inputs and outputs of one experiment, by name."""

    inputs: tuple[InputTrace, ...]
    outputs: tuple[Trace, ...]

    @property
    def step(self) -> float:
        return float(np.median(np.diff(self.outputs[0].time)))


@dataclass(frozen=True)
class Responses:
    """The charts of an effect, or the ``note`` that says why there are none."""

    charts: tuple[Chart, ...]
    note: str = ""


def responses(verdict: Verdict, effect: Effect) -> Responses | None:
    """The frequency responses that show an effect; None where it is none that they show."""
    members = () if effect.one_of is None else effect.one_of.members
    names = {effect.mechanism, *(m.mechanism for m in members)}
    if effect.memory is None and not any(LIBRARY[name].linear for name in names if name in LIBRARY):
        return None
    there = _alike(_recorded(verdict))
    if not there:
        return None
    free = [one for one in there if not _under_feedback(one, verdict.settings.chance)]
    found = _estimated(free or there)
    charts = (
        [] if found is None else _charts(free or there, found, effect, _feedback(there, verdict) if not free else None)
    )
    if not charts:
        told = "No frequency response is drawn: the inputs excite too few frequencies for one that stands out of its uncertainty."
        return Responses((), told)
    return Responses(tuple(charts[:MOST_PAIRS]))


def _recorded(verdict: Verdict) -> list[Recorded]:
    """By experiment, those that the models follow and that are long enough to say anything."""
    found = []
    shown = validation_traces(verdict)
    for name in dict.fromkeys(t.experiment for t in shown):
        outputs = tuple(t for t in shown if t.experiment == name)
        inputs = tuple(i for i in verdict.inputs if i.experiment == name)
        if inputs and len(outputs[0].time) > 2 and all(_followed(t) for t in outputs):
            found.append(Recorded(inputs, outputs))
    return found


def _followed(trace: Trace) -> bool:
    size = 1e3 * float(np.nanmax(np.abs(trace.measured), initial=0.0))
    both = np.abs([trace.refit, trace.augmented])
    return bool(np.isfinite(both).all() and both.max() <= size and np.isfinite(trace.measured).any())


def _alike(recorded: Sequence[Recorded]) -> list[Recorded]:
    """Those of the sample time that most samples have."""
    groups: dict[float, list[Recorded]] = {}
    for one in recorded:
        groups.setdefault(float(f"{one.step:.3g}"), []).append(one)
    return max(groups.values(), key=lambda g: sum(len(one.outputs[0].time) for one in g), default=[])


def _under_feedback(one: Recorded, chance: float) -> bool:
    """Whether an input answers to what the model after does not explain of an output."""
    errors = [t.measured - t.augmented for t in one.outputs]
    return any(input_answers(e, i.values, chance / (len(errors) * len(one.inputs))) for e in errors for i in one.inputs)


def _feedback(recorded: Sequence[Recorded], verdict: Verdict) -> dict[str, float]:
    """By input, the frequency (Hz) beyond which hardly anything is in it but the controller's answer to noise and distortion: there an
    estimate shows the inverse of the controller.
    """
    share = verdict.settings.excited_share
    every = ((i.input, excited_band(_whole(i.values), one.step, share)) for one in recorded for i in one.inputs)
    bands: dict[str, float] = {}
    for name, band in every:
        bands[name] = max(bands.get(name, 0.0), band)
    return bands


def _estimated(recorded: Sequence[Recorded]) -> Response | None:
    """From all inputs to every output as measured, before and after, and to what the model after leaves of it, in this order."""
    inputs = [np.stack([_whole(i.values) for i in one.inputs]) for one in recorded]
    outputs = [np.concatenate([_rows(t) for t in one.outputs]) for one in recorded]
    return frequency_response(inputs, outputs, recorded[0].step)


def _rows(trace: Trace) -> np.ndarray:
    """An output (4, N) as measured, before, after, and measured less after."""
    return np.stack(
        [_whole(v) for v in (trace.measured, trace.refit, trace.augmented, trace.measured - trace.augmented)]
    )


def _whole(values: np.ndarray) -> np.ndarray:
    """Missing samples bridged by straight lines."""
    known = np.flatnonzero(np.isfinite(values))
    return np.interp(np.arange(len(values)), known, values[known]) if known.size else np.zeros(len(values))


def _charts(
    recorded: Sequence[Recorded], found: Response, effect: Effect, band: Mapping[str, float] | None
) -> list[Chart]:
    """Of the pairs that the effect concerns, those that stand out; the best determined first.

    Args:
        band: under feedback, by input the frequency in Hz up to which it is excited from outside.
    """
    kind, _, of = effect.port.partition(".")
    drawn = []
    for j, one in enumerate(recorded[0].inputs):
        for i, trace in enumerate(recorded[0].outputs):
            if (kind == "actuator" and of not in ("", one.input)) or (
                kind == "sensor" and of not in ("", trace.output)
            ):
                continue
            radius = REGION * np.sqrt(found.variance[4 * i, j])
            if band is not None:
                radius = np.where(found.frequency <= band[one.input], radius + _bent(found, i, j), np.inf)
            pair = _clear(found.frequency, found.gain[4 * i : 4 * i + 3, j], radius)
            if pair is not None:
                drawn.append((len(pair.frequency), bode(pair, one, trace, len(recorded), feedback=band is not None)))
    return [chart for _, chart in sorted(drawn, key=lambda d: -d[0])]


def _bent(found: Response, i: int, j: int) -> np.ndarray:
    """The most (F,) by which noise that is fed back can bend the response from input j to output i, if all of the input were its answer.

    By the inequality of Cauchy and Schwarz for the cross spectrum of input and noise, for which what the model after leaves stands.

    Source: L. Ljung, System Identification, 2nd ed., 1999, section 13.4.
    """
    return np.sqrt(found.outputs[4 * i + 3] / np.maximum(found.inputs[j], 1e-300))


def _clear(frequency: np.ndarray, gains: np.ndarray, radius: np.ndarray) -> Curves | None:
    """The part of a response that stands out of its uncertainty; gaps within it are NaN."""
    amplitude = np.abs(gains[0])
    clear = np.isfinite(radius) & (amplitude > 0) & (radius < CERTAIN * amplitude) & (np.abs(gains[1:]) > 0).all(axis=0)
    if clear.sum() < FEWEST:
        return None
    kept = _together(np.flatnonzero(clear))
    part = slice(kept[0], kept[-1] + 1)
    measured, before, after = np.where(clear, gains, np.nan)[:, part]
    return Curves(frequency[part], measured, before, after, np.where(clear, radius, np.nan)[part])


def _together(places: np.ndarray) -> np.ndarray:
    """The places (K,) of clear frequencies, rising, without a last or first one that stands far from all others."""
    far = APART * np.median(np.diff(places))
    if places[-1] - places[-2] > far:
        places = places[:-1]
    return places[1:] if places[1] - places[0] > far else places
