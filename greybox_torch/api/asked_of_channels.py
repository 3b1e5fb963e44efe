"""What a user is asked of channels where an estimate simulates the validation experiments badly: exchanged, turned, of another scale?"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from greybox_torch.api.exchanged import exchanged, exchanged_of_other_units
from greybox_torch.api.rescaled import rescaled, rescaled_output
from greybox_torch.api.short_refits import Asked, beginnings
from greybox_torch.api.turned_in_one import turned_in_one
from greybox_torch.api.with_friction import changed_with_friction, friction_explains_more
from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Score, held_out_scores, mean_fit
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import Simulator

POOR = 80.0
"""Mean fit in % below which it is asked."""

FAR_BETTER_SO = "With one of these changes the fit is far better: the results ask about it"
NOTHING_CHANGED = "With none of these changes is the fit far better. A sign or scale may still be wrong: what the model lacks may hide it"
"""What came of it, in the log."""


def asked_where_poor(
    data: DataSet,
    model: GreyBoxModel,
    refit: Sequence[Score],
    simulator: Callable[[], Simulator],
    progress: Callable[[str], None],
    values: Mapping[str, float] | None = None,
) -> Asked | None:
    """The question of :func:`exchanged`, or else of the other ways in their order, where the re-estimated model, with the scores ``refit``,
    is poor on the validation experiments.

    Args:
        simulator: makes the one that is needed then.
        progress: is told of it, as it takes as long as a few short refits.
        values: the parameters of the estimate, with which :func:`rescaled_output` is asked last; not, where None.
    """
    if not poor(refit) or beginnings(data) is None:
        return None
    progress(
        "The validation fit is poor: trying short refits with channels exchanged, of the other sign, or in another unit or scale"
    )
    made, achieved = simulator(), mean_fit(held_out_scores(refit))
    ways = (exchanged, exchanged_of_other_units, turned_in_one, _scale, changed_with_friction)
    question = next((asked for way in ways if (asked := way(data, model, made, achieved))), None)
    if question is None and values is not None:
        question = rescaled_output(data, model, made, refit, values)
    progress(FAR_BETTER_SO if question else NOTHING_CHANGED)
    return question


def _scale(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """The question of :func:`rescaled`, unless dry friction explains as much by itself. Seen: a factor of 10 on a torque (42 %) where the
    model lacked dry friction.
    """
    asked = rescaled(data, model, simulator, achieved)
    if asked is None or friction_explains_more(data, model, simulator, asked.reaches):
        return None
    return asked


def poor(scores: Sequence[Score]) -> bool:
    """Whether the scores of a model are so poor on the validation experiments that it is asked."""
    return not mean_fit(held_out_scores(scores)) >= POOR
