"""Further start values for a hypothesis, against local minima."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import identity_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def restarts(
    study: Study, screened: Sequence[Sequence[ScreenScore]], ranked: RankedCandidate
) -> list[dict[str, float]]:
    """Start values against local minima, the base's from the card, the newest effect's shape as probes of the screen had it.

    Of the shapes that explain about as much, some from end to end: between them the optimum may be narrower than the probes' grid.
    """
    most, effect, values = study.budget.most_shapes, ranked.candidate.attachment, ranked.fitted.values()
    explained: dict[tuple[tuple[str, float], ...], float] = {}
    for score in (k for at in screened for k in at if identity_of(k.attachment) == identity_of(effect)):
        shape = tuple(sorted((f"{effect.prefix}.{n}", v) for n, v in score.probe.values.items() if n != "order"))
        explained[shape] = max(explained.get(shape, 0.0), np.nan_to_num(score.explained))
    best = sorted(explained, key=lambda shape: -explained[shape])
    tied = [shape for shape in best if explained[shape] > study.settings.shapes_tie * explained[best[0]]]
    chosen = _from_end_to_end(sorted(tied), most) if len(tied) > most else best[:most]
    shaped = [{**values, **study.card, **dict(shape)} for shape in chosen]
    return shaped + _neighbouring_orders(study, effect, values)


def _from_end_to_end(shapes: Sequence[tuple[tuple[str, float], ...]], most: int) -> list[tuple[tuple[str, float], ...]]:
    """A few of many, evenly spread."""
    return [shapes[round(k)] for k in np.linspace(0, len(shapes) - 1, most)]


def _neighbouring_orders(study: Study, effect: Attachment, values: dict[str, float]) -> list[dict[str, float]]:
    """For a periodic effect, orders by which its phase shifts by a quarter period or more over the travel.

    Along short windows positions are less exact than over long ones, where the order they suggest may lie in the next valley.
    """
    name = f"{effect.prefix}.order"
    if name not in values:
        return []
    step = 0.5 * np.pi / study.surroundings[effect.port].ranges["position"].span
    return [{**values, name: values[name] + shift * step} for shift in study.budget.order_shifts]
