"""A free curve as it was drawn first, where held-out experiments do not bear out a finer one.

How fine a curve is drawn is chosen by the experiments that it is fitted to: of many knots each may have been passed once or twice, and
follows what was particular there. Seen: a brake along a part of a rail, whose curve of 14 knots removed 64 % of the held-out error; of 56
knots, which fitted half as much again, it added 66 %, and names that are not the machine's were told in its place.
"""

from __future__ import annotations

from functools import partial

from greybox_torch.diagnosis.confirm.held_out import HeldOut, gain
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.side_by_side import side_by_side


def with_coarser_curve(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """The state with its curve as the screen drew it, where held-out experiments do not bear it out beyond chance as it is, and that is
    better; else as it is.

    Not beside laws: a coarser curve may do what one of them does. Seen: a stage's dry friction with a constant force, of which it left 9 %.
    """
    coarse = _as_drawn_first(state)
    if coarse is None:
        return state
    plain, fine, first = side_by_side(partial(others.fits, h) for h in (state.plain, state.current, coarse))
    surely = study.settings.held_out_beyond_chance
    if gain(plain, fine).errors_away > surely or gain(fine, first).errors_away <= surely:
        return state
    state = state.at(coarse)
    yield state
    return (yield from drop_superfluous(study, state))


def _as_drawn_first(state: SearchState) -> Hypothesis | None:
    """The hypothesis with the curve of the step that took it; None where that has as many knots, or there is more than a curve."""
    if len(state.effects) != 1 or not isinstance(curve := state.effects[0].mechanism, Unknown):
        return None
    done = state.step_of(state.effects[0].prefix)
    first = None if done is None or done.taken is None else done.taken.fitted
    if first is None or len(first.effects) != 1:
        return None
    drawn = first.effects[0].mechanism
    return first if isinstance(drawn, Unknown) and drawn.knots < curve.knots else None
