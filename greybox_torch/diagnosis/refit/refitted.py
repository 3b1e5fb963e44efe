"""A hypothesis with other effects, refitted from one that was fitted before."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.diagnosis.hypothesis.fit import POLISH_SETTINGS, Hypothesis, hypothesis
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def refitted(
    study: Study, effects: Sequence[Attachment], start: Hypothesis, starts: Sequence[dict[str, float]] = ()
) -> Hypothesis | None:
    """The model with ``effects``, fitted from the values of ``start``, from the card's, and from further ``starts``.

    None where it cannot be simulated from any of them.
    """
    return hypothesis(
        study.problem,
        effects,
        study.surroundings,
        [start.values(), {**start.values(), **study.card}, *starts],
        options=study.options,
        shorter=start.fits[0],
        settings=POLISH_SETTINGS,
    )
