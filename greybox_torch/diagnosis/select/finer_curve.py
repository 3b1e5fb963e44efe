"""The free curve that was just taken, drawn more finely."""

from __future__ import annotations

from greybox_torch.diagnosis.hypothesis.fit import WINDOW_SETTINGS, hypothesis
from greybox_torch.diagnosis.refit.curve import finer
from greybox_torch.diagnosis.select.choice import CURVE_MARGIN, LEAST_GAIN
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown

MOST_PARAMETERS = 70
"""Free parameters of a hypothesis, beyond which its curve is not drawn any finer."""


def with_finer_curve(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with its newest effect, a curve, drawn with twice the knots, and so on, as long as that pays."""
    while len(state.current.problem.free_names) + _knots(state.effects[-1]) < MOST_PARAMETERS:
        study.working_on("drawing the curve more finely")
        drawn = state.current
        attachment, values = finer(drawn, drawn.effects[-1], study.surroundings)
        fitted = hypothesis(
            study.problem,
            (*drawn.effects[:-1], attachment),
            study.surroundings,
            [values],
            options=study.options,
            shorter=drawn.fits[0],
            settings=WINDOW_SETTINGS,
        )
        if fitted is None or fitted.score > drawn.score - LEAST_GAIN:
            break
        state = state.at(fitted)
        yield state
        if fitted.score >= drawn.score - CURVE_MARGIN:
            break
    return state


def _knots(curve: Attachment) -> int:
    assert isinstance(curve.mechanism, Unknown)
    return curve.mechanism.knots
