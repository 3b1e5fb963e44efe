"""Whether all amplitudes of an effect together are more than chance, where none of them is alone.

The stiffness and the damping of a hard stop trade for one another: neither is determined, and together they are, far beyond chance.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.linear_algebra import solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings


def within_one_deviation(final: Final, effect: Attachment, surroundings: Mapping[str, Surroundings]) -> bool:
    """Whether the free amplitudes of an effect, fitted to whole records, lie within one deviation of zero, all k of them together.

    By Wald's statistic a' C⁻¹ a, which is k on average by chance, with the larger of the plain and the sandwich covariance C of the law's
    parameters; those that are no amplitudes stay as they are. False where the deviations are not known, or some are infinite.

    Source: A. Wald, Transactions of the American Mathematical Society 54, 1943.
    """
    amplitudes = {f"{effect.prefix}.{n}" for n in effect.mechanism.amplitudes(surroundings[effect.port])}
    own = [i for i, name in enumerate(final.problem.free_names) if name.startswith(f"{effect.prefix}.")]
    names, values = [final.problem.free_names[i] for i in own], final.values()
    sizes = np.array([values[name] if name in amplitudes else 0.0 for name in names])
    if final.uncertainty is None or not sizes.any() or set(own) & set(final.uncertainty.undetermined):
        return False
    covariances = (c[np.ix_(own, own)] for c in (final.uncertainty.plain, final.uncertainty.sandwich))
    least = min(float(sizes @ solve(c, sizes)) for c in covariances)
    return bool(least < len(amplitudes.intersection(names)))
