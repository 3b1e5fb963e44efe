"""Where most of the mismatch is left, small effects beside a larger one are refinements: any law takes up a part of so much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.standing import refinements
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.mechanisms.actuator import InputBias
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias

EFFECTS = (Attachment("rotor", ConstantBias()), Attachment("actuator", InputBias()))
LARGE, SMALL = (e.prefix for e in EFFECTS)


def with_errors(fitted: Hypothesis, times: float) -> Hypothesis:
    """A hypothesis whose errors are so many times as large."""
    return replace(fitted, fits=tuple(replace(f, energies=times**2 * f.energies) for f in fitted.fits))


@pytest.mark.parametrize(
    ("left", "small", "told"),
    [(0.78, 0.08, False), (0.3, 0.08, True), (0.78, 0.15, True)],
    ids=["most is left", "most is removed", "a large part"],
)
def test_a_small_effect_beside_a_larger_one(dead_zone_search, stub, left: float, small: float, told: bool) -> None:
    """Seen: a hoop whose drive's law is a stand-in, told with waves over 3.5 periods of its travel (0.50)."""
    plain = with_errors(dead_zone_search.plain, 100.0)
    full = with_errors(plain, np.sqrt(left))
    state = stub(effects=EFFECTS, prefixes={LARGE, SMALL}, plain=plain, current=full)
    others = stub(times_noise=lambda hypothesis: np.array([21.0]), fits=lambda hypothesis: hypothesis.fits)
    some = refinements(dead_zone_search.study, state, others, {}, {LARGE: 0.22, SMALL: small})
    assert some == (set() if told else {SMALL})
