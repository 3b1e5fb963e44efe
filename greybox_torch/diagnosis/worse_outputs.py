"""Outputs that the recommended model simulates worse, though all of them together no worse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.traces import Trace
from greybox_torch.estimate.comparison import Score

WORSE = 0.01
"""Share by which the root mean square error of an output has to be larger for it to be told."""


def worse_outputs(before: Sequence[Score], after: Sequence[Score], traces: Sequence[Trace]) -> tuple[str, ...]:
    """A sentence for each output whose error on the validation experiments is larger with the recommended model than re-estimated.

    Seen: a pressure sensor that clipped, whose error went from 0.379 to 0.388 bar with a friction that was found, and not a word of it.

    Args:
        before: scores of the model as it stands, re-estimated, on the experiments that count; ``after`` of the recommended one.
        traces: of the outputs, which have the units.
    """
    units = {trace.output: trace.unit for trace in traces}
    before, after = ([s for s in scores if s.role == "validation"] for scores in (before, after))
    found, outputs = [], list(dict.fromkeys(s.output for s in before))
    for output in outputs if len(outputs) > 1 else []:
        errors = [_error(scores, output) for scores in (before, after)]
        if np.isfinite(errors[0]) and errors[1] > (1.0 + WORSE) * errors[0]:
            places = next(n for n in range(3, 9) if digits(errors[0], n) != digits(errors[1], n))
            told = [f"{digits(error, places)} {units.get(output, '')}".rstrip() for error in errors]
            found.append(
                f"With what was found {output} is simulated worse on the validation experiments, root mean square error {told[0]} before "
                f"and {told[1]} with it, though all outputs together no worse."
            )
    return tuple(found)


def _error(scores: Sequence[Score], output: str) -> float:
    """Root mean square error of an output over the experiments."""
    return float(np.sqrt(np.mean([s.rmse**2 for s in scores if s.output == output])))
