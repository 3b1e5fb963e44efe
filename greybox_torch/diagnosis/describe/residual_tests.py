"""What the free run's errors give away before any hypothesis is tried: their colour, what past inputs still explain of them, feedback.

The errors of the free run are the ones to look at: they depend on nothing but what came before. Those over short windows do not, as start
states that are fitted to a window have seen its later inputs, which would look like feedback. Nothing here decides anything: what is
claimed rests on predictions of held-out data.

Source: L. Ljung, "System Identification: Theory for the User", 2nd ed., sections 13.4 and 16.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from scipy.special import ndtri

from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.traces import Trace
from greybox_torch.estimate.excitation import excited_band
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.residuals import NORMAL_99, Correlation, feedback_correlation, input_correlation, whiteness

MOST_BOUND = 0.7
"""Bound of a correlation from which one within it says nothing: half of the errors' variance may be hidden below."""


@dataclass(frozen=True)
class Largest:
    """The largest absolute correlation over some lags, and the ``bound`` that it keeps with 99 % where there is nothing to find."""

    value: float
    bound: float

    @property
    def told(self) -> str:
        """Its size in words: none that is below one is rounded to one."""
        return "above 0.99" if self.value >= 0.995 else f"{self.value:.2g}"

    @property
    def beyond(self) -> bool:
        """Whether it is more than chance."""
        return self.value > self.bound

    @property
    def judged(self) -> bool:
        """Whether it says anything: no correlation exceeds a bound of one, however short or slow the recordings, and hardly any one that is
        nearly as large.
        """
        return self.bound < (1.0 if self.beyond else MOST_BOUND)

    @property
    def ratio(self) -> float:
        """Its size in bounds."""
        return self.value / max(self.bound, 1e-300)


@dataclass(frozen=True)
class Remains:
    """What the errors of one model show: autocorrelation (``colour``), and correlation with inputs before (``past``)."""

    colour: Largest
    past: Largest


@dataclass(frozen=True)
class Detection:
    """One output of one estimation experiment: the errors of the model as it stands (``plain``) and of the recommended one (``final``).

    ``later`` is the correlation of what is new in an input with what is new in the errors before it; ``band`` (Hz) is the end of the
    excited band. Under feedback, the correlation with past inputs is that within the excited band.
    """

    experiment: str
    output: str
    plain: Remains
    final: Remains
    later: Largest
    band: float

    @property
    def feedback(self) -> bool:
        """Whether the input answers to the output, or is recorded later than it acts or with noise of its own."""
        return self.later.beyond


def detect(problem: Problem, traces: Sequence[Trace], settings: DiagnosisSettings) -> tuple[Detection, ...]:
    """The detection for every trace of an estimation experiment whose free runs do not run away.

    Args:
        problem: the model as it stands on the experiments of ``traces``.
    """
    records = problem.records
    looked = [t for t in traces if t.role == "estimation" and len(records.u) and _followed(t, settings.runaway)]
    first = 1 if _acts_at_once(problem) else 0
    inputs = (records.u[:, records.span(records.names.index(t.experiment))] for t in looked)
    return tuple(_detection(t, u, len(looked), first, settings) for t, u in zip(looked, inputs, strict=True))


def input_answers(errors: np.ndarray, signal: np.ndarray, chance: float) -> bool:
    """Whether an input (N,) answers to errors (N,) before it, as one under feedback does, with so much ``chance`` of a false alarm."""
    found = feedback_correlation(errors, signal)
    return _largest(found, found.lags > 0, 1, chance).beyond


def _acts_at_once(problem: Problem) -> bool:
    """Whether an output can answer to the input of the same sample: by the hold, or by the model's own output equation."""
    u = torch.as_tensor(problem.records.u)
    x = torch.as_tensor(problem.initial[0])[:, None].expand(-1, u.shape[1])
    y = problem.model.measured(x, u, problem.parameter_tensors)
    return problem.records.hold != "zoh" or bool((y != y[:, :1]).any())


def _followed(trace: Trace, runaway: float) -> bool:
    """Whether the free runs stay with the measurement, by orders of magnitude, and there is one."""
    largest = np.nanmax(np.abs(trace.measured), initial=0.0)
    return largest > 0 and bool(np.max(np.abs([trace.refit, trace.augmented])) < runaway * largest)


def _detection(trace: Trace, inputs: np.ndarray, records: int, first: int, settings: DiagnosisSettings) -> Detection:
    final, plain = trace.measured - trace.augmented, trace.measured - trace.refit
    step, tests = float(np.median(np.diff(trace.time))), records * len(inputs)
    band = max(excited_band(signal, step, settings.excited_share) for signal in inputs)
    answers = (feedback_correlation(final, signal) for signal in inputs)
    later = _worst([_largest(c, c.lags >= first, tests, settings.chance) for c in answers])
    # the noise that a controller passes on to the input lies where nothing else excites it: there, correlation says nothing of physics
    reach = band * step if later.beyond else np.inf
    before, after = (_remains(errors, inputs, reach, records, settings.chance) for errors in (plain, final))
    return Detection(trace.experiment, trace.output, before, after, later, band)


def _remains(errors: np.ndarray, inputs: np.ndarray, reach: float, records: int, chance: float) -> Remains:
    of_themselves = whiteness(errors)
    kept = _up_to(errors, reach)
    with_inputs = [input_correlation(kept, _up_to(signal, reach)) for signal in inputs]
    return Remains(
        _largest(of_themselves, of_themselves.lags > 0, records, chance),
        _worst([_largest(c, c.lags >= 0, records * len(inputs), chance) for c in with_inputs]),
    )


def _up_to(signal: np.ndarray, reach: float) -> np.ndarray:
    """A signal (N,) without its part above ``reach`` (cycles per sample); missing samples count as its mean."""
    if reach >= 0.5:
        return signal
    spectrum = np.fft.rfft(np.nan_to_num(signal - np.nanmean(signal)))
    spectrum[np.fft.rfftfreq(len(signal)) > reach] = 0.0
    return np.fft.irfft(spectrum, len(signal))


def _largest(correlation: Correlation, lags: np.ndarray, tests: int, chance: float) -> Largest:
    """The largest of some lags, with a bound for the largest of all lags of so many tests (Bonferroni)."""
    values = np.abs(correlation.values[lags])
    wider = -ndtri(chance / 2 / (tests * max(len(values), 1))) / NORMAL_99
    return Largest(float(values.max(initial=0.0)), float(wider * correlation.bound))


def _worst(found: Sequence[Largest]) -> Largest:
    return max(found, key=lambda largest: largest.ratio)
