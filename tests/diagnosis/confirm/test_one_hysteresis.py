"""Several elements that slip, and the hysteresis that they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.standing import refinements
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.transmission import HystereticSpring
from greybox_torch.model import Body, Coupling


@pytest.mark.parametrize(("rate", "told"), [("speed", 1), (lambda x, u, p: x.speed - x.other, 2)])
def test_two_elements_that_slip_with_one_motion_are_one_hysteresis(dead_zone_search, stub, rate, told) -> None:
    """Seen: the four slip elements of a piezo stack, told as two laws (0.97 and 0.93), 14 and 22 % of the mismatch each."""
    ports = (Body("stage", speed="speed"), Coupling("stack", deflection="position", rate=rate))
    problem = stub(**vars(dead_zone_search.study.problem) | {"model": stub(ports=ports)})
    study = replace(dead_zone_search.study, problem=problem)
    effects = (Attachment("stack", HystereticSpring()), Attachment("stage", PreslidingHysteresis()))
    prefixes = [e.prefix for e in effects]
    state = stub(effects=effects, prefixes=set(prefixes), current=dead_zone_search.plain)
    others = stub(times_noise=lambda hypothesis: np.array([92.0]))
    small = refinements(study, state, others, {}, dict(zip(prefixes, [0.14, 0.22], strict=True)))
    assert small == ({"stack.hysteretic_spring"} if told == 1 else set())
