"""How much of what an effect does the other parameters of a model undo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.window_information import window_information
from greybox_torch.linear_algebra import solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings


def not_undone(fitted: Hypothesis, effect: Attachment, surroundings: Mapping[str, Surroundings]) -> float:
    """The share of what an effect does to the outputs, in squares, that no change of the model's and other laws' parameters undoes.

    Linearised at the fitted values over the shortest windows, start states free: over longer ones a single window that is about to slip may
    outweigh all others. A sensor that shows a third of what it should, beside a spring three times as stiff, does next to nothing: the
    little that remains is whatever the model lacks. A free curve undoes nothing: it takes up whatever it can. One where nothing is known.
    """
    known = window_information(fitted.fits[0], fitted.simulator)
    if known is None:
        return 1.0
    names, values = fitted.problem.free_names, fitted.values()
    curves = tuple(f"{e.prefix}." for e in fitted.effects if e.mechanism.free)
    own = [i for i, name in enumerate(names) if name.startswith(f"{effect.prefix}.")]
    rest = [i for i, name in enumerate(names) if i not in own and not name.startswith(curves)]
    sizes = effect.mechanism.essential or effect.mechanism.amplitudes(surroundings[effect.port])
    amplitude = np.array([values[names[i]] * (names[i].removeprefix(f"{effect.prefix}.") in sizes) for i in own])
    return made_up_for(known, own, rest, amplitude)[1]


def made_up_for(
    known: np.ndarray, own: Sequence[int], rest: Sequence[int], amplitude: np.ndarray
) -> tuple[np.ndarray, float]:
    """How other parameters move to make up for a law, and the share of its squared output that is left; all where it has none.

    Args:
        known: the information (n_p, n_p) of all free parameters; ``own`` are the law's, with ``amplitude``, ``rest`` those that move.
    """
    whole = float(amplitude @ known[np.ix_(own, own)] @ amplitude)
    onto = known[np.ix_(rest, own)] @ amplitude
    # What the others undo is the projection onto them; the Schur complement is what is left.
    moves = solve(known[np.ix_(rest, rest)], onto) if len(rest) else onto
    share = (whole - float(onto @ moves)) / whole if whole > 0 else 1.0
    return -moves, float(np.clip(share, 0.0, 1.0)) if np.isfinite(share) else 1.0
