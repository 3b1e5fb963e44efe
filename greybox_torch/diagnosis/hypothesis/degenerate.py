"""Whether the fitted parameters of an effect say anything about the machine."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings


def degenerate(
    effect: Attachment,
    surroundings: Mapping[str, Surroundings],
    values: Mapping[str, float],
    deviations: Mapping[str, float] | None = None,
) -> str | None:
    """A clause that says why a law with these parameters is none of the machine's; None where there is nothing to object to.

    Args:
        values: parameters by their full names.
        deviations: their standard deviations, where those are known.
    """
    # What is not determined by itself (a phase beside a start angle) may be so together with others.
    finite = {n: d for n, d in (deviations or {}).items() if np.isfinite(d)}
    start = f"{effect.prefix}."
    own, known = (
        {n.removeprefix(start): v for n, v in some.items() if n.startswith(start)} for some in (values, finite)
    )
    return effect.mechanism.degenerate(surroundings[effect.port], own, known)
