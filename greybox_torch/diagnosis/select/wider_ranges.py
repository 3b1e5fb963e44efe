"""What was found estimated anew over the ranges that signals have with it, where a free curve's signal moves beyond its range."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.same_effects import with_same_effects
from greybox_torch.diagnosis.select.search import without_idle_bumps
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.estimate.window_fit import states_along
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.unknown import Unknown

RARE = 0.0005
"""Share of the samples of a state, at either end, that say nothing of where it moves."""


def over_wider_ranges(study: Study, state: SearchState) -> tuple[Study, SearchState] | None:
    """The study with the ranges as the hypothesis of ``state`` has them, and its effects estimated over these; None where its curve has
    room, or where over them as much as a finding is left.

    A curve is level beyond the range over which it is drawn: where the model as it stands moved. A state that no sensor shows may go much
    farther once the model is right, and what the curve then cannot follow is told as a further effect. Seen: the foot of a hopper, which
    the pad held in the model as it stands: a curve of its position, and a stiffness of the pad beside it (0.97).
    """
    if not state.has_curve or only_noise(study.problem, state.current, study.settings):
        return None
    curves = [e for e in state.effects if isinstance(e.mechanism, Unknown)]
    around = ranges_with(study, state.current)
    if not any(_beyond(study, c.mechanism.signals(), study.surroundings[c.port], around[c.port]) for c in curves):
        return None
    study, begun = replace(study, surroundings=around), state.at(state.plain)
    same = with_same_effects(study, begun, state)
    if same is begun:
        return None
    return study, result_of(without_idle_bumps(study, result_of(drop_superfluous(study, same))))


def ranges_with(study: Study, fitted: Hypothesis, rare: float = RARE) -> dict[str, Surroundings]:
    """Where the signals around every port of the model as it stands move with the effects of a hypothesis, but for a ``rare`` share of the
    samples at either end.

    Over its longest windows, which begin least often: where a state that no sensor shows begins, a window may not say.
    """
    model, over = study.problem.model, fitted.fits[-1]
    names = [s.name for s in fitted.model.states]
    states = states_along(over, fitted.simulator)[:, [names.index(s.name) for s in model.states]]
    low, high = np.quantile(states, [rare, 1.0 - rare], axis=0)
    return surroundings_along(model, over.problem, np.clip(states, low, high))


def _beyond(study: Study, signals: tuple[str, ...], drawn: Surroundings, now: Surroundings) -> bool:
    """Whether one of the signals moves beyond its range, on one side, by a part of it that counts."""
    shared = [s for s in signals if s in drawn.ranges and s in now.ranges]
    return any(_exceeds(drawn.ranges[s], now.ranges[s], study.settings.beyond_its_range) for s in shared)


def _exceeds(drawn: Range, now: Range, share: float) -> bool:
    room = share * drawn.span
    return bool(np.isfinite([now.low, now.high]).all() and (now.low < drawn.low - room or now.high > drawn.high + room))
