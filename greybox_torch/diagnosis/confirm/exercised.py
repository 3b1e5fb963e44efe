"""Whether held-out experiments exercise an effect: whether they come out otherwise without it, all else as it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.confirm.held_out import gain, held_out_fits
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_fit import WindowFit


def untouched(there: tuple[WindowFit, ...], full: tuple[WindowFit, ...], settings: DiagnosisSettings) -> bool:
    """Whether held-out experiments come out alike without an effect and with all other values as they are.

    Seen: a stage whose amplifier reached its limit in one experiment alone: what the other parameters gained beside it (0.4 ± 0.3 % of the
    squared error) was all that held-out experiments showed, and it was taken back.

    Args:
        there: the hypothesis so, on the held-out experiments.
        full: the hypothesis with all effects on them.
    """
    return gain(there, full).unexercised(settings)


def hardly_exercised(
    study: Study, state: SearchState, prefix: str, there: tuple[WindowFit, ...], full: tuple[WindowFit, ...]
) -> bool:
    """Whether that changes their errors by next to nothing of what it changes in the experiments that the effect was estimated from.

    Then how large it is those have to say. Seen: a motor that runs against its stop again and again where it is estimated, and once
    elsewhere: 10 % of the mismatch and 0.02 %, for which it was no finding.

    ``there`` and ``full`` as for :func:`untouched`.
    """
    values, substeps = state.current.values(), study.options.substeps
    own = [
        held_out_fits(h, study.problem, h.simulator.with_substeps(substeps), values, study.budget)
        for h in (state.without[prefix], state.current)
    ]
    return _change(there, full) < study.settings.hardly_exercised * _change(*own)


def _change(without: Sequence[WindowFit], full: Sequence[WindowFit]) -> float:
    """By how much the mean squared weighted error rises without an effect: the most over the window lengths."""
    pairs = zip(without, full, strict=False)
    rises = (float(np.sum(w.energies) - np.sum(f.energies)) / f.problem.samples for w, f in pairs)
    return max(rises, default=0.0)
