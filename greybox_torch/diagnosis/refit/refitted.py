"""A hypothesis with other effects, refitted from one that was fitted before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, hypothesis
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment


def refitted(
    study: Study, effects: Sequence[Attachment], start: Hypothesis, starts: Sequence[dict[str, float]] = ()
) -> Hypothesis | None:
    """The model with ``effects``, fitted from the values of ``start``, from the card's, and from further ``starts``.

    None where it cannot be simulated from any of them.
    """
    begun = [start.values(), {**start.values(), **study.card}, *starts]
    return fit(study, effects, begun, start.fits[0], beside=start)


def polished(
    study: Study, fitted: Hypothesis, starts: Sequence[Mapping[str, float]] = (), beside: Hypothesis | None = None
) -> Hypothesis:
    """``fitted`` refitted to convergence, also from further start values; the better of the two.

    Args:
        beside: a fit of other effects, whose values and start states are tried too.
    """
    simulator, before = (None, None) if fitted.frozen else (fitted.simulator, fitted)
    begun, shorter = [fitted.values(), *starts], fitted.fits[0]
    again = fit(study, fitted.effects, begun, shorter, simulator=simulator, before=before, beside=beside)
    return fitted if again is None or again.score > fitted.score else again


def fit(
    study: Study,
    effects: Sequence[Attachment],
    starts: Sequence[Mapping[str, float]],
    shorter: WindowFit | None,
    *,
    limits: Settings | None = None,
    **how: Any,
) -> Hypothesis | None:
    """:func:`hypothesis` of a study, by default to convergence."""
    return hypothesis(
        study.problem,
        effects,
        study.surroundings,
        starts,
        options=study.options,
        shorter=shorter,
        limits=limits or study.budget.polish_iterations,
        settings=study.settings,
        budget=study.budget,
        places=study.places,
        **how,
    )
