"""The size of an effect: which part of the mismatch of the model as it stands it accounts for."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.hypothesis.same_lengths import by_length
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.window_fit import WindowFit


def size(
    plain: tuple[WindowFit, ...],
    without: tuple[WindowFit, ...],
    full: tuple[WindowFit, ...],
    settings: DiagnosisSettings,
) -> float:
    """The share of the mismatch of ``plain`` that leaving an effect out of ``full`` brings back: the mean over window lengths.

    The mismatch is the squared error beyond what the noise alone would leave. Where the plain model cannot be simulated, or leaves no
    more than noise, the whole is what the model without the effect leaves. A length over which neither leaves more says nothing of an
    effect, as start states take up there what it does; where that is so of every length, its size is zero. Over a length at which it does
    harm (a stop, hit at another instant in one short window) nothing is brought back.
    """
    shares, as_it_stands, left_out = [], by_length(plain), by_length(without)
    for length, new in by_length(full).items():
        old = left_out.get(length)
        if old is None:
            shares.append(1.0)
            continue
        whole = as_it_stands.get(length, old)
        noise = noise_floor(new.problem, settings) * new.problem.samples
        brought_back = float(old.energies.sum()) - float(new.energies.sum())
        mismatch = max(float(whole.energies.sum()) - noise, brought_back)
        if mismatch > settings.no_mismatch * noise:
            shares.append(max(brought_back, 0.0) / mismatch)
    return float(np.mean(shares)) if shares else 0.0 if full else float("nan")
