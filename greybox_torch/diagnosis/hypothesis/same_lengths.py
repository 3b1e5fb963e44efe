"""Fits of hypotheses over windows of the same lengths: over some length one may have no fit, as it overflows there."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.estimate.window_fit import WindowFit


def over_same_lengths(*fits: Sequence[WindowFit]) -> list[tuple[WindowFit, ...]]:
    """For every window length that all have a fit of, shortest first, the fits of each."""
    known = [by_length(of_one) for of_one in fits]
    return [tuple(k[length] for k in known) for length in known[0] if all(length in k for k in known)]


def by_length(fits: Sequence[WindowFit]) -> dict[int, WindowFit]:
    """Fits by the length of their windows in samples."""
    return {fit.windows.steps: fit for fit in fits}
