"""How much of what an effect does the other parameters of a model undo."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.window_information import window_information
from greybox_torch.linear_algebra import solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings


def not_undone(fitted: Hypothesis, effect: Attachment, surroundings: Mapping[str, Surroundings]) -> float:
    """The share of what an effect does to the outputs, in squares, that no change of all other parameters undoes.

    Linearised at the fitted values, start states of windows free, at the window length where most is left. A sensor that shows a third of
    what it should, beside a spring three times as stiff, does next to nothing: the little that remains is whatever the model lacks.
    One where nothing is known of it.
    """
    names, values = fitted.problem.free_names, fitted.values()
    own = [i for i, name in enumerate(names) if name.startswith(f"{effect.prefix}.")]
    rest = [i for i in range(len(names)) if i not in own]
    sizes = effect.mechanism.amplitudes(surroundings[effect.port])
    amplitude = np.array(
        [values[names[i]] if names[i].removeprefix(f"{effect.prefix}.") in sizes else 0.0 for i in own]
    )
    informations = (window_information(fit, fitted.simulator) for fit in fitted.fits)
    shares = [
        _share(i[np.ix_(own, own)], i[np.ix_(rest, rest)], i[np.ix_(rest, own)], amplitude)
        for i in informations
        if i is not None
    ]
    return max((s for s in shares if np.isfinite(s)), default=1.0)


def _share(own: np.ndarray, rest: np.ndarray, across: np.ndarray, amplitude: np.ndarray) -> float:
    """Of the squared output aᵀ H a, what is left of it beside the others: the Schur complement's share; NaN where it does nothing."""
    whole = float(amplitude @ own @ amplitude)
    undone = float(amplitude @ across.T @ solve(rest, across) @ amplitude) if len(rest) else 0.0
    return (whole - undone) / whole if whole > 0 else float("nan")
