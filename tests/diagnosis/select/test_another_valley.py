"""A far better fit of the hypothesis so far, found while rivals are polished, is where the step begins anew if only a curve leads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import forward_step as module
from greybox_torch.diagnosis.select.compare import Comparison, compare
from greybox_torch.diagnosis.select.forward_step import forward_step
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.unknown import Unknown

SETTINGS = DiagnosisSettings()


@pytest.mark.parametrize(
    ("leads", "known", "farther", "steps"),
    [("curve", (), 0.2, 2), ("curve", (), 0.05, 1), ("law", (), 0.2, 1), ("curve", ({},), 0.2, 1)],
)
def test_the_step_is_repeated_once_from_there(
    dead_zone_search, motor, monkeypatch, leads, known, farther, steps
) -> None:
    """Seen: a lathe's saturation and friction that warms up, told as unknown: the fit before them sat in a local minimum.

    Not where the curve is the one that a search with fewer experiments came to, and completes the model here as well.
    """
    study, state = dead_zone_search.study, dead_zone_search.state
    mechanism = Unknown("input", 4) if leads == "curve" else ActuatorDeadzone()
    effect = attach(motor, "actuator", mechanism)
    fitted = dead_zone_search.refitted((effect,), state.plain)
    leader = judged(Candidate(effect, (), 0.5, found_before=known), state.plain, fitted, SETTINGS)
    monkeypatch.setattr(module, "completes", lambda fitted, settings: True)
    fits = tuple(replace(f, mean_square=f.mean_square * np.exp(farther)) for f in state.plain.fits)
    worse = replace(state.plain, fits=fits)
    begun = []

    def compared(of, parent, screened, ranked):
        begun.append(parent)
        return Comparison(state.plain, (leader,)) if len(begun) < 3 else compare(of, parent, screened, ranked)

    monkeypatch.setattr(module, "compare", compared)
    monkeypatch.setattr(module, "with_finer_curve", lambda of, done: (yield done) or done)
    found = result_of(forward_step(study, replace(state, plain=worse, current=worse)))
    assert len(begun) == steps and begun[0] is worse
    assert begun[-1] is (state.plain if steps == 2 else worse)
    assert found.plain is state.plain and [step.parent for step in found.steps] == [state.plain]
