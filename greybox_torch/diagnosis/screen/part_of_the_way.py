"""Free curves over a part of where a body goes: a notch, a joint of a rail, a tooth that is worn.

What acts along a fiftieth of the way needs as many knots along all of it, and most of their heights would follow something else. Hence the
screen has narrow bumps along the whole way, and the few neighbours that explain most together are a curve, which is zero elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from greybox_torch.diagnosis.screen.linear_answer import LinearAnswer
from greybox_torch.diagnosis.screen.score_test import Screen, ScreenScore
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body
from greybox_torch.simulation.side_by_side import side_by_side


def curves_over_parts(
    study: Study, effects: Sequence[Attachment], fits: Sequence[WindowFit]
) -> tuple[tuple[ScreenScore, ...], ...]:
    """By window length, for every body the curve over the part of its way that explains most of what ``fits`` with ``effects`` leave.

    Also of a position that has to be integrated from the speed, which begins at zero in every experiment.
    """
    along = Unknown("position", study.budget.knots_along_parts)
    bodies = [q.name for q in study.problem.model.ports if isinstance(q, Body)]
    able = [name for name in bodies if along.available(study.surroundings[name])]
    offered = [a for a in (attach(study.problem.model, name, along) for name in able) if not study.beliefs.exclude(a)]
    if not offered:
        return tuple(() for _ in fits)
    names = fits[-1].problem.free_names
    screen = Screen.of(study.problem.model, effects, offered, study.surroundings, names, study.options)

    def scores(fitted: WindowFit) -> tuple[ScreenScore, ...]:
        answer = LinearAnswer.of(screen.projected(fitted).total(), fitted)
        return tuple(_best_parts(study, screen, fitted, answer))

    return tuple(side_by_side((lambda fitted=fitted: scores(fitted)) for fitted in fits))


def _best_parts(study: Study, screen: Screen, fitted: WindowFit, answer: LinearAnswer) -> Iterator[ScreenScore]:
    """For every body the curve of neighbouring bumps that explains most of the residual."""
    _, before = answer.beside_parameters(np.arange(0))
    at = len(screen.free_names)
    for group, (along, _) in zip(screen.directions, screen.probed, strict=True):
        knots = min(study.budget.knots_of_part, len(group))
        answers = [answer.beside_parameters(np.arange(at + k, at + k + knots)) for k in range(len(group) - knots + 1)]
        at += len(group)
        best = int(np.argmin([left if np.isfinite(left) else np.inf for _, left in answers]))
        size, left = answers[best]
        assert isinstance(along.mechanism, Unknown)
        centres = along.mechanism.centres(study.surroundings[along.port])
        law = Unknown(along.mechanism.signal, knots, part=(centres[best], centres[best + knots - 1]))
        curve = attach(study.problem.model, along.port, law)
        (probe,) = law.probes(study.surroundings[along.port])
        explained = (before - left) / max(before, 1e-300)
        yield ScreenScore(curve, probe, fitted.windows.steps, explained, size)
